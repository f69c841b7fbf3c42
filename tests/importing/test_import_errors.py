# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Input that is no colon: the message says what was found and what to pass, and nothing stays behind."""

from __future__ import annotations

import gzip
import signal
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
import trimesh
from label_volumes import course

from arcgym.anatomy.importing import ColonImportError, ImportSettings, import_to_folder
from arcgym.anatomy.importing.orientation import orient


def volume(path: Path, values: np.ndarray, spacing: float = 2.0) -> Path:
    image = sitk.GetImageFromArray(values)
    image.SetSpacing([spacing] * 3)
    sitk.WriteImage(image, str(path.with_name(path.name.lower())))
    return path.with_name(path.name.lower()).rename(path)


def refused(path: Path, match: str, settings: ImportSettings | None = None) -> None:
    with pytest.raises(ColonImportError, match=match):
        import_to_folder(path, path.parent / "out", settings or ImportSettings(voxel=0.004))
    assert [left.name for left in path.parent.iterdir() if left != path] == []


def ball(size: int = 40, radius: float = 15) -> np.ndarray:
    offset = np.indices((size,) * 3) - size / 2
    return (np.linalg.norm(offset, axis=0) < radius).astype(np.uint8)


def test_empty_mask(tmp_path: Path) -> None:
    refused(volume(tmp_path / "a.mha", np.zeros((9, 9, 9), np.uint8)), "no voxel above 0.*--label")


def test_several_labels(tmp_path: Path) -> None:
    refused(volume(tmp_path / "a.nii.gz", ball() * np.uint8(3) + np.uint8(1)), r"2 labels \(1, 4\).*--label")


def test_missing_label(tmp_path: Path) -> None:
    refused(volume(tmp_path / "a.nrrd", ball()), "no voxel of label 7", ImportSettings(label=7))


def test_gray_values_are_no_labels(tmp_path: Path) -> None:
    gray = np.random.default_rng(0).integers(-1000, 2000, (80, 80, 80)).astype(np.int16)
    refused(volume(tmp_path / "a.mha", gray), "gray values of a CT.*segmentation")


def test_ball_is_no_colon(tmp_path: Path) -> None:
    refused(volume(tmp_path / "a.mha", ball()), "No colon-like component")


def test_implausible_spacing(tmp_path: Path) -> None:
    refused(volume(tmp_path / "a.mha", ball(), spacing=0.001), "0.001 x 0.001 x 0.001 mm.*--spacing")


def test_nan_volume(tmp_path: Path) -> None:
    refused(volume(tmp_path / "a.mha", np.full((9, 9, 9), np.nan, np.float32)), "NaN")


@pytest.mark.parametrize("name", ["a.nii", "a.nii.gz"])
@pytest.mark.parametrize(
    ("place", "match"), [(80, "spacing of nan x 2 x 2 mm. Pass --spacing"), (280, "axes that are no")]
)
def test_nifti_header_with_nan(name: str, place: int, match: str, tmp_path: Path) -> None:
    """ITK would take a spacing of 1 mm and say nothing."""
    path = volume(tmp_path / name, ball())
    opened = gzip.open if name.endswith(".gz") else open
    with opened(path, "rb") as file:
        data = bytearray(file.read())
    data[place : place + 4] = struct.pack("<f", float("nan"))
    data[254:256] = struct.pack("<h", 1)
    with opened(path, "wb") as file:
        file.write(data)
    refused(path, match)


def test_text_header_with_nan(tmp_path: Path) -> None:
    path = volume(tmp_path / "a.mha", ball())
    path.write_bytes(path.read_bytes().replace(b"ElementSpacing = 2 2 2", b"ElementSpacing = 2 nan 2"))
    refused(path, "says 'ElementSpacing = 2 nan 2'. Pass --spacing")


def test_spacing_that_is_given_may_be_missing_in_the_file(tmp_path: Path) -> None:
    path = volume(tmp_path / "a.nii", ball())
    data = bytearray(path.read_bytes())
    data[80:84] = struct.pack("<f", float("nan"))
    path.write_bytes(data)
    refused(path, "No colon-like component", ImportSettings(voxel=0.004, spacing=(2.0, 2.0, 2.0)))


def test_solid_body(tmp_path: Path) -> None:
    refused(volume(tmp_path / "a.mha", np.ones((80, 80, 80), np.uint8)), "fills 100% of the box round it")


def test_lumen_that_does_not_fit_into_memory(tmp_path: Path) -> None:
    """Two voxels in opposite corners of half a meter, on voxels of 0.5 mm: 1.2e9 of them."""
    values = np.zeros((100, 100, 100), np.uint8)
    values[0, 0, 0] = values[-1, -1, -1] = 1
    path = volume(tmp_path / "a.mha", values, spacing=5.0)
    refused(path, "million voxels of 0.5 mm, about .* GB;.*--voxel", ImportSettings(voxel=0.0005))


def test_ball_of_80_units_is_no_colon_in_centimeters(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    trimesh.creation.icosphere(subdivisions=3, radius=40).export(path)
    refused(path, "80 units long, which is no colon's size in mm, cm or m")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_stopped_import_leaves_nothing(number: signal.Signals, tmp_path: Path) -> None:
    """The signal comes while a folder is half made; the process ends with 128 and its number, in one line."""
    code = (
        "import os, signal, sys, tempfile, time\n"
        "from arcgym.cli.stopping import stopped_cleanly\n"
        f"with stopped_cleanly('out was not made'), tempfile.TemporaryDirectory(dir={str(tmp_path)!r}):\n"
        f"    os.kill(os.getpid(), {int(number)})\n"
        "    time.sleep(20)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 128 + number
    assert done.stderr == f"stopped by {number.name}: out was not made\n"
    assert list(tmp_path.iterdir()) == []


def test_two_signals_at_once_are_one_line(tmp_path: Path) -> None:
    """Ctrl-C reaches a data set and its import, to which the data set then sends SIGTERM."""
    code = (
        "import os, signal\n"
        "from arcgym.cli.stopping import stopped_cleanly\n"
        "both = {signal.SIGINT, signal.SIGTERM}\n"
        "with stopped_cleanly('out was not made'):\n"
        "    signal.pthread_sigmask(signal.SIG_BLOCK, both)\n"
        "    for each in both:\n"
        "        os.kill(os.getpid(), each)\n"
        "    signal.pthread_sigmask(signal.SIG_UNBLOCK, both)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stderr == "stopped by SIGINT: out was not made\n"
    assert done.returncode == 128 + signal.SIGINT


def test_header_of_more_voxels_than_a_ct_has(tmp_path: Path) -> None:
    """Found before ITK takes 100 GB for them."""
    path = tmp_path / "a.mha"
    path.write_text(
        "ObjectType = Image\nNDims = 3\nDimSize = 10000 10000 1000\nElementType = MET_UCHAR\n"
        "ElementSpacing = 1 1 1\nElementDataFile = LOCAL\n"
    )
    refused(path, "10000 x 10000 x 1000 voxels, 100.0 billion; the limit is 2 billion")


@pytest.mark.parametrize("name", ["a.mha", "a.nii", "a.nii.gz", "a.nrrd", "A.NII.GZ"])
def test_truncated_volume(name: str, tmp_path: Path) -> None:
    path = volume(tmp_path / name, np.random.default_rng(0).integers(0, 2, (40, 40, 40)).astype(np.uint8))
    path.write_bytes(path.read_bytes()[:2000])
    refused(path, "cannot be (read|unpacked).*complete")


def test_packed_volume_cut_off(tmp_path: Path) -> None:
    path = tmp_path / "a.mha.gz"
    path.write_bytes(b"\x1f\x8b\x08\x00 no gzip")
    refused(path, "cannot be unpacked")


def test_unknown_kind(tmp_path: Path) -> None:
    path = tmp_path / "a.dcm"
    path.write_bytes(b"x")
    refused(path, "no known kind.*\\.nrrd")


def test_surface_of_no_known_unit(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    trimesh.creation.icosphere(subdivisions=3, radius=50_000).export(path)
    refused(path, "no colon's size.*--units")


def test_big_ball_is_no_colon(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    trimesh.creation.icosphere(subdivisions=3, radius=200).export(path)
    refused(path, "No colon-like component: the lumen fills 5.% of the box", ImportSettings(voxel=0.01))


def test_surface_with_nan(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    trimesh.creation.icosphere(subdivisions=3, radius=200).export(path)
    lines = path.read_text().splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("v "))
    lines[first] = "v nan 0 0"
    path.write_text("\n".join(lines))
    refused(path, "NaN")


@pytest.mark.parametrize("name", ["a.stl", "a.ply", "a.vtk", "a.vtp", "a.glb"])
def test_damaged_surface(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(b"this is no surface")
    refused(path, "cannot be read|holds")


def test_ends_that_look_alike() -> None:
    """A straight level tube reads the same from both ends."""
    line = np.linspace([-0.2, 0.0, 0.0], [0.2, 0.0, 0.0], 50)
    with pytest.raises(ColonImportError, match="cannot be told apart.*--anus"):
        orient(line * [0, 1, 1] + [[0, k, 0] for k in np.linspace(-0.2, 0.2, 50)], "ras", ends_known=False)


def test_file_whose_sides_are_exchanged() -> None:
    """As it is, the tube's course is like a colon's (above 0.9); mirrored, it is not from either end."""
    line = course()[0]
    assert not orient(line, "ras", ends_known=False).mirrored
    with pytest.raises(ColonImportError, match=r"of the mirror image 0\.9.*Left and right may be exchanged.*--anus"):
        orient(line * [-1, 1, 1], "ras", ends_known=False)


def test_mirrored_surface_that_fits_other_axes_is_still_told() -> None:
    """Turned by half a turn, a mirrored course has its sides right and its front at the back: likeness 0.6 to 0.75."""
    line = course()[0]
    assert not orient(line, "auto", ends_known=False).mirrored
    assert orient(line * [-1, 1, 1], "auto", ends_known=False).mirrored
