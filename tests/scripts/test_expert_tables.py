# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tables of how far experts get, from folders of ``arcgym bench experts``."""

from __future__ import annotations

import json
import runpy
from pathlib import Path
from typing import Any

import pytest

TOOL = runpy.run_path(str(Path(__file__).resolve().parents[2] / "scripts" / "tools" / "expert_tables.py"))


def row(patient: str, reached: float, *segments: str, problem: str | None = None) -> dict[str, Any]:
    entry = {"time": 30.0, "tip_peak": 1.0, "window_peak": 2.0, "drive_peak": 3.0, "inserted": 1.5}
    about = {"patient": patient, "robot": "magnetic", "tissue": "paper", "scope_length": 2.2, "length": 1.9}
    ended = {"problem": problem, "held_by": "2 N on the tip", "time": 40.0}
    return about | ended | {"reached": reached, "segments": {name: entry for name in ("rectum", *segments)}}


@pytest.fixture
def folders(tmp_path: Path) -> list[Path]:
    """Two runs: the second goes on with the patient that the first had to leave."""
    contents = {
        "one": {
            "rows": [row("patient_10000", 1.85, "transverse", "cecum")],
            "unfinished": [row("patient_10001", 1.2, "transverse", problem="no computing time left")],
        },
        "two": {"rows": [row("patient_10001", 1.84, "transverse", "cecum")], "unfinished": []},
    }
    for folder, files in contents.items():
        (tmp_path / folder).mkdir()
        for name, rows in files.items():
            (tmp_path / folder / f"{name}.jsonl").write_text("".join(json.dumps(one) + "\n" for one in rows))
    return [tmp_path / folder for folder in contents]


def test_a_drive_that_was_cut_off_counts_with_how_far_it_came(folders: list[Path], tmp_path: Path) -> None:
    rows = TOOL["gathered"](folders[:1])
    assert "| magnetic of 2.2 m | paper | 100 (34–100) | 50 (9–91) | 30 (30) | 1.0 (1.0) |" in TOOL["summary"](rows)
    TOOL["write"](rows, tmp_path / "rows.csv")
    lines = (tmp_path / "rows.csv").read_text().splitlines()
    assert lines[1] == "10000,magnetic,paper,2.2,1.90,1.85,40,cecum,1.0,2.0,3.0,1.50,,,"
    assert lines[2].endswith("transverse,1.0,2.0,3.0,1.50,no computing time left,2 N on the tip,")


def test_rows_of_a_file_stay_but_for_what_was_driven_again(folders: list[Path], tmp_path: Path) -> None:
    file = tmp_path / "rows.csv"
    TOOL["write"](TOOL["gathered"](folders[:1]), file, "abc1234")
    TOOL["write"](TOOL["gathered"](folders[1:]), file, "def5678")
    _, first, second = file.read_text().splitlines()
    assert first.endswith(",abc1234") and second.endswith("cecum,1.0,2.0,3.0,1.50,,,def5678")


def test_a_later_end_takes_its_place(folders: list[Path]) -> None:
    for order in (folders, folders[::-1]):
        assert [one["reached"] for one in TOOL["gathered"](order)] == [1.85, 1.84]
