# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A folder of masks: what is taken, whose it is, how patients are split, what is not done twice."""

from __future__ import annotations

import csv
import json
import os
import signal
import threading
import time
from pathlib import Path

import pytest
from label_volumes import write_volume

from arcgym.anatomy.importing import ImportArgumentError
from arcgym.anatomy.importing.dataset import COLUMNS, find_scans, outcome, split_of, split_text
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


REPORT = {
    "made_by": "arcgym import-colon",
    "checks": [],
    "doubts": [],
    "length_mm": 1500.0,
    "lumen_radius_mm": {"p50": 20.0},
    "orientation": {"likeness": 0.9},
    "widened_for_head": {"share": 0.1},
    "cleaning": {"cut": []},
    "seconds": {"read": 1.0},
}


def reported(release: Path, **changes: object) -> Path:
    """Write the report of an import of colon_001 and return the folder of the data set."""
    folder = release.parent / "colons" / "colon_001"
    folder.mkdir(parents=True)
    (folder / "report.json").write_text(json.dumps(REPORT | changes))
    return folder.parent


@pytest.mark.parametrize(("doubts", "status", "named"), [([], "imported", 1), (["likeness 0.3"], "doubtful", 0)])
def test_kept_but_doubtful_colons_are_in_no_split(doubts: list[str], status: str, named: int, release: Path) -> None:
    out = reported(release, doubts=doubts)
    row = outcome(find_scans(release)[0], out)
    assert row is not None and row["status"] == status
    sides = json.loads(split_text([row]))
    assert sum(len(sides[side]) for side in ("train", "validation", "test")) == named


def test_report_without_figures_is_named(release: Path, capsys: pytest.CaptureFixture) -> None:
    out = reported(release, orientation={})
    with pytest.raises(SystemExit, match="2"):
        run_command("import-dataset", [str(release), str(out)])
    assert "colon_001/report.json lacks figures ('likeness')" in capsys.readouterr().err


def slow_import(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, last: str = "sleep 60") -> None:
    """Let a script stand for import-colon, which says when it begins and is told to end."""
    script = tmp_path / "import.sh"
    told = f"trap 'touch {tmp_path}/told; exit 143' TERM"
    script.write_text(f"#!/bin/bash\n{told}\ntouch {tmp_path}/begun\n{last} & wait\n")
    script.chmod(0o755)
    monkeypatch.setattr("arcgym.cli.import_dataset.sys.executable", str(script))


def test_stopped_data_set_stops_its_imports(
    release: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    slow_import(tmp_path, monkeypatch)

    def stop() -> None:
        while not (tmp_path / "begun").exists():
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=stop).start()
    began = time.monotonic()
    with pytest.raises(SystemExit, match="143"):
        run_command("import-dataset", [str(release), str(tmp_path / "colons")])
    assert time.monotonic() - began < 30.0
    assert (tmp_path / "told").exists()
    assert "stopped by SIGTERM" in capsys.readouterr().err


def test_import_that_takes_too_long_is_told_to_end_and_refused(
    release: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow_import(tmp_path, monkeypatch)
    out = tmp_path / "colons"
    assert run_command("import-dataset", [str(release), str(out), "--limit", "1", "--timeout", "1"]) == 1
    assert (tmp_path / "told").exists()
    assert "not done after 1 s" in rows(out)[0]["problem"]


def test_import_that_is_killed_is_refused_and_the_rest_goes_on(
    release: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow_import(tmp_path, monkeypatch, "kill -9 $$")
    out = tmp_path / "colons"
    assert run_command("import-dataset", [str(release), str(out)]) == 1
    assert [("killed" in row["problem"]) for row in rows(out)] == [True, True]


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
