# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Input that is no colon: the message says what was found and what to pass, and nothing stays behind."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
import trimesh

from arcgym.anatomy.importing import ColonImportError, ImportSettings, import_to_folder
from arcgym.anatomy.importing.orientation import orient


def volume(path: Path, values: np.ndarray, spacing: float = 2.0) -> Path:
    image = sitk.GetImageFromArray(values)
    image.SetSpacing([spacing] * 3)
    sitk.WriteImage(image, str(path))
    return path


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
    refused(volume(tmp_path / "a.mha", gray), "grey values of a CT.*segmentation")


def test_ball_is_no_colon(tmp_path: Path) -> None:
    refused(volume(tmp_path / "a.mha", ball()), "No colon-like component")


def test_implausible_spacing(tmp_path: Path) -> None:
    refused(volume(tmp_path / "a.mha", ball(), spacing=0.001), "0.001 x 0.001 x 0.001 mm.*--spacing")


def test_nan_volume(tmp_path: Path) -> None:
    refused(volume(tmp_path / "a.mha", np.full((9, 9, 9), np.nan, np.float32)), "NaN")


@pytest.mark.parametrize("name", ["a.mha", "a.nii", "a.nii.gz", "a.nrrd"])
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
    refused(path, "No colon-like component: a ball of 3.. mm", ImportSettings(voxel=0.01))


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
