# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A folder of masks: what is taken, whose it is, how patients are split, what is not done twice."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from label_volumes import write_volume

from arcgym.anatomy.importing import ImportArgumentError
from arcgym.anatomy.importing.dataset import COLUMNS, find_scans, split_of
from arcgym.cli.main import run_command

METADATA = [
    {"nnunet_label_file": "colon_001.mha", "subject_id": "sub007", "Position": "prone", "Sex": "F"},
    {"nnunet_label_file": "colon_002.mha", "subject_id": "sub007", "Position": "supine", "Sex": "F"},
]


@pytest.fixture
def release(tmp_path: Path) -> Path:
    """Return a folder like one of the HQColon release, its meta-data.json above it; no file in it can be read."""
    folder = tmp_path / "data" / "Segmentation Air and Fluid"
    folder.mkdir(parents=True)
    for name in ("colon_001.mha", "colon_002.mha", "readme.txt"):
        (folder / name).write_text("no volume")
    (folder.parent / "meta-data.json").write_text("\n".join(map(json.dumps, METADATA)) + "\n")
    return folder


def test_release_says_who_and_how_they_lay(release: Path) -> None:
    scans = find_scans(release)
    assert [(scan.name, scan.patient, scan.posture) for scan in scans] == [
        ("colon_001", "sub007", "prone"),
        ("colon_002", "sub007", "supine"),
    ]
    assert scans[0].about == "sub007 female"


@pytest.mark.parametrize(
    ("name", "pattern", "patient", "posture"),
    [
        ("sub012_pos-prone_scan_1.nii.gz", "", "sub012", "prone"),
        ("A7-Supine.stl", "", "A7", "supine"),
        ("a_b.mha", r"^\w_(\w)", "b", "supine"),
    ],
)
def test_patient_by_name(name: str, pattern: str, patient: str, posture: str, tmp_path: Path) -> None:
    (tmp_path / name).touch()
    (scan,) = find_scans(tmp_path, patient=pattern)
    assert (scan.patient, scan.posture) == (patient, posture)


@pytest.mark.parametrize(
    ("names", "settings", "match"),
    [
        (["a.txt"], {}, r"holds no '\*' that ends in .mha"),
        (["x/a.mha", "y/a.mha"], {}, "Two files are called a: .*--pattern"),
        (["a.mha"], {"patient": "("}, "--patient is '\\('"),
        (["a.mha"], {"patient": "sub"}, "Pass a group for the patient"),
        (["a.mha"], {"metadata": Path("none.json")}, "--metadata: none.json does not exist"),
    ],
)
def test_folders_that_cannot_be_imported(names: list[str], settings: dict, match: str, tmp_path: Path) -> None:
    for name in names:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    with pytest.raises(ImportArgumentError, match=match):
        find_scans(tmp_path, **settings)


def test_split_goes_by_patient_and_keeps_its_shares() -> None:
    sides = [split_of(f"sub{k:03d}") for k in range(2000)]
    assert sides == [split_of(f"sub{k:03d}") for k in range(2000)]
    for side, share in (("train", 0.8), ("validation", 0.1), ("test", 0.1)):
        assert sides.count(side) / 2000 == pytest.approx(share, abs=0.03)


def rows(out: Path) -> list[dict[str, str]]:
    with (out / "table.csv").open() as file:
        return list(csv.DictReader(file))


def test_refused_files_are_in_the_table_and_not_tried_again(release: Path, capsys: pytest.CaptureFixture) -> None:
    out = release.parent / "colons"
    assert run_command("import-dataset", [str(release), str(out), "--limit", "1"]) == 1
    (row,) = rows(out)
    assert set(row) == set(COLUMNS)
    assert (row["name"], row["status"], row["split"]) == ("colon_001", "refused", "")
    assert "cannot be read" in row["problem"]
    assert json.loads((out / "splits.json").read_text()) == {"version": 1, "train": [], "validation": [], "test": []}
    (out / "refused" / "colon_001.txt").write_text("error: said before")
    assert run_command("import-dataset", [str(release), str(out), "--limit", "1"]) == 1
    assert "1 files, 1 done before" in capsys.readouterr().out
    assert rows(out)[0]["problem"] == "error: said before"


def test_options_after_two_dashes_go_to_the_import(tmp_path: Path) -> None:
    """Wherever the command's own options stand; import-colon says what is wrong with them before any work."""
    folder = tmp_path / "masks"
    folder.mkdir()
    write_volume(folder / "tube_prone.mha")
    command = [str(folder), str(tmp_path / "colons"), "--licence", "CC0", "--", "--voxels", "3"]
    with pytest.raises(SystemExit, match="2"):
        run_command("import-dataset", command)
    assert "unknown flag '--voxels'" in (tmp_path / "colons" / "logs" / "tube_prone.log").read_text()


@pytest.mark.slow
def test_mask_becomes_a_colon_once(tmp_path: Path) -> None:
    folder, out = tmp_path / "masks", tmp_path / "colons"
    folder.mkdir()
    write_volume(folder / "tube_prone.mha")
    command = [str(folder), str(out), "--licence", "CC0", "--", "--voxel", "3"]
    assert run_command("import-dataset", command) == 0
    (row,) = rows(out)
    assert (row["patient"], row["posture"], row["status"]) == ("tube", "prone", "imported")
    assert float(row["length_mm"]) > 1000.0
    assert json.loads((out / "splits.json").read_text())[split_of("tube")] == ["tube_prone"]
    made = (out / "tube_prone" / "colon.usda").stat().st_mtime_ns
    assert run_command("import-dataset", command) == 0
    assert (out / "tube_prone" / "colon.usda").stat().st_mtime_ns == made
