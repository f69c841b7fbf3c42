# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Settings and paths that cannot be right are refused before anything is read."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import pytest

from arcgym.anatomy.importing import ImportArgumentError, ImportSettings
from arcgym.anatomy.importing.arguments import parse_landmark, parse_point
from arcgym.anatomy.importing.preflight import check_paths

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "tools" / "import_colon.py"


@pytest.fixture
def mask(tmp_path: Path) -> Path:
    """Return a file with the name of a label volume, which nothing can read."""
    path = tmp_path / "mask.nii.gz"
    path.write_bytes(b"no volume")
    return path


@pytest.mark.parametrize(
    ("settings", "match"),
    [
        ({"sectors": 3}, "sectors is 3. Pass 6 to 96"),
        ({"max_gap": float("nan")}, "max_gap is nan"),
        ({"voxel": 1e-6}, r"voxel is 1e-06 m \(0.001 mm\). Pass 0.0003 to 0.01 m \(0.3 to 10 mm in commands\)"),
        ({"landmarks": {"foo": 0.003}}, "Unknown landmark 'foo'. Available: cecum_entry"),
        ({"landmarks": {"rectosigmiod": 0.15}}, "Did you mean 'rectosigmoid'"),
        ({"landmarks": {"rectosigmoid": -0.1}}, "at -0.1. Pass an arc length"),
        ({"units": "inch"}, "units is 'inch'. Pass one of auto, mm, cm, m"),
        ({"frame": "las"}, "frame is 'las'. Pass one of auto, ras"),
        ({"posture": "left"}, "posture is 'left'. Pass one of supine, prone"),
        ({"label": (1, 0)}, "label is 0, the background"),
        ({"spacing": (1.0, 0.0, 1.0)}, "spacing is .*Pass three numbers above 0"),
        ({"anus": (1.0, 2.0)}, "anus is .*X,Y,Z"),
        ({"name": ""}, "name is ''"),
        ({"name": "-rf"}, "name is '-rf'. Pass letters"),
        ({"name": "a\nb"}, "Pass letters, digits"),
    ],
)
def test_impossible_setting(settings: dict, match: str) -> None:
    with pytest.raises(ImportArgumentError, match=match):
        ImportSettings(**settings)


def test_landmark_is_an_arc_length_or_a_position() -> None:
    assert parse_landmark("rectosigmoid=150") == ("rectosigmoid", pytest.approx(0.150))
    assert parse_landmark("cecum_entry=12,-40,95") == ("cecum_entry", (12.0, -40.0, 95.0))


@pytest.mark.parametrize("text", ["rectosigmoid", "rectosigmoid=far", "rectosigmoid=1,2"])
def test_landmark_in_another_form(text: str) -> None:
    with pytest.raises(ImportArgumentError, match="--landmark.*Pass"):
        parse_landmark(text)


def test_point_of_two_numbers() -> None:
    with pytest.raises(ImportArgumentError, match="--anus is '1,2'. Pass X,Y,Z"):
        parse_point("1,2", "--anus")


def test_folder_as_input(tmp_path: Path) -> None:
    with pytest.raises(ImportArgumentError, match="is a folder. Pass one file that ends in .mha"):
        check_paths(tmp_path, tmp_path / "out", False)


def test_output_below_a_file(mask: Path) -> None:
    with pytest.raises(ImportArgumentError, match="cannot be made: .*mask.nii.gz is a file"):
        check_paths(mask, mask / "deep" / "out", False)


def test_output_that_exists(mask: Path, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with pytest.raises(ImportArgumentError, match="out exists. Pass another folder, or --overwrite"):
        check_paths(mask, tmp_path / "out", False)


def test_overwrite_keeps_folders_of_others(mask: Path, tmp_path: Path) -> None:
    """A folder with thesis.tex is refused, an empty one and an earlier import are taken."""
    out = tmp_path / "out"
    out.mkdir()
    check_paths(mask, out, True)
    (out / "report.json").write_text('{"made_by": "arcgym import-colon"}')
    for name in ("colon.usda", "mucosa_albedo.jpg", "preview.png"):
        (out / name).touch()
    check_paths(mask, out, True)
    (out / "thesis.tex").touch()
    with pytest.raises(ImportArgumentError, match="out is not replaced: thesis.tex in it is not of an import"):
        check_paths(mask, out, True)


def test_overwrite_keeps_a_folder_that_only_looks_like_an_import(mask: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    for name in ("colon.usda", "report.json"):
        (out / name).touch()
    with pytest.raises(ImportArgumentError, match="neither empty nor a folder made by an import"):
        check_paths(mask, out, True)


def test_overwrite_keeps_the_inputs_folder(tmp_path: Path) -> None:
    for name in ("colon.usda", "report.json", "mask.mha"):
        (tmp_path / name).touch()
    with pytest.raises(ImportArgumentError, match="is not replaced"):
        check_paths(tmp_path / "mask.mha", tmp_path, True)


def test_command_exits_with_2_and_one_line(mask: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    out = mask.parent / "out"
    monkeypatch.setattr(sys, "argv", ["import_colon.py", str(mask), str(out), "--landmark", "foo=3"])
    with pytest.raises(SystemExit) as stopped:
        runpy.run_path(str(SCRIPT), run_name="__main__")
    assert stopped.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("import_colon.py: error: Unknown landmark 'foo'")
    assert not out.exists()
