# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Result folders that somebody wrote into: the check says in one line what is wrong, and never ends in a traceback."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from result_folders import TASK, write_result_folder

from arcgym.cli.main import main

Lines = list[str]


def check(folder: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """Status and text of ``arcgym results check``."""
    capsys.readouterr()
    try:
        status = main(["results", "check", str(folder)])
    except SystemExit as error:
        status = int(error.code or 0)
    seen = capsys.readouterr()
    return status, seen.out + seen.err


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda lines: [*lines[:3], lines[0], *lines[3:]], "Line 4 of"),
        (lambda lines: [*lines[:2], lines[2].replace(f"{TASK},", f"{TASK},more,")], "Line 3 of"),
        (lambda lines: [*lines[:2], lines[2].rpartition(",")[0]], "has 13 cells, expected 14, as the heading has"),
        (lambda lines: [*lines[:2], lines[2] + ",1"], "has 15 cells, expected 14, as the heading has"),
        (lambda lines: [*lines[:1], lines[1].replace(",2.0,", ",two,")], "seconds = two, expected a number"),
        (lambda lines: lines[:1], "trials.csv has no row"),
        (lambda lines: [], "trials.csv has no row"),
    ],
)
def test_damaged_rows_are_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], damage: Callable[[Lines], Lines], message: str
) -> None:
    path = write_result_folder(tmp_path / "mine", 30)
    file = path / "trials.csv"
    file.write_text("".join(f"{line}\n" for line in damage(file.read_text().splitlines())))
    status, text = check(path, capsys)
    assert status != 0 and message in text


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"suite": None}, "suite is 'None', expected one of paper"),
        ({"agent": "magic"}, "agent is 'magic', expected checkpoint, zero, random, expert"),
        ({"overrides": None}, "overrides is 'None', expected a list of texts"),
        ({"versions": None}, "versions is 'None', expected versions by name"),
        ({"checkpoint_sha256": "abc"}, "checkpoint_sha256 is 'abc', expected a list of hashes"),
        ({"changes": []}, "changes is '[]', expected registered and used value by field, by task"),
        ({"changes": {TASK: {"start": "rest"}}}, "expected registered and used value by field, by task"),
        ({"changes": {TASK: ["start"]}}, "expected registered and used value by field, by task"),
        ({"inputs": {TASK: {"sees": ["policy"]}}}, "expected 'sees' and 'simulator_depth' by task"),
    ],
)
def test_a_damaged_run_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], changes: dict[str, Any], message: str
) -> None:
    path = write_result_folder(tmp_path / "mine", 30)
    file = path / "run.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | changes))
    status, text = check(path, capsys)
    assert status != 0 and message in text


def test_a_run_of_no_entries_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_result_folder(tmp_path / "mine", 30)
    (path / "run.json").write_text("[]")
    status, text = check(path, capsys)
    assert status == 2 and "run.json is damaged: it holds a list, expected entries by name" in text
