# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Results of a journey whose episodes counted as stuck sooner."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from result_folders import write_result_folder

from arcgym.evaluation.baselines import baselines_of, read_baselines, updated, write_baselines
from arcgym.evaluation.compare import notes
from arcgym.evaluation.results import Result, find_results
from arcgym.evaluation.results_page import _earlier, _newest
from arcgym.evaluation.task_settings import PATIENCE, PHYSICS_STEP

TASK = "ARC-LeftColon-Magnetic"


@pytest.fixture
def results(tmp_path: Path) -> dict[str, Result]:
    """The expert's trials of before, which do not say, and of now."""
    of: dict[str, Any] = {"suite": "left_colon", "agent": "expert", "checkpoint": [], "checkpoint_sha256": []}
    of |= {"training": [], "changes": {TASK: {}}, "physics_hz": {TASK: PHYSICS_STEP.registered(TASK)}}
    for name, said in (("old", {"stuck_after_s": {}}), ("new", {"stuck_after_s": {TASK: 20.0}})):
        write_result_folder(tmp_path / name, 0, TASK, **of | said)
    found, left_out = find_results([tmp_path])
    assert left_out == {}
    return {one.folder.name: one for one in found}


def test_the_time_of_a_run() -> None:
    assert PATIENCE.registered("ARC-Sigmoid-Magnetic") == 6.0
    assert PATIENCE.in_run({}, TASK) == 6.0 and PATIENCE.in_run({"stuck_after_s": {TASK: 20.0}}, TASK) == 20.0
    assert PATIENCE.in_run({}, "ARC-Withdrawal-Capsule") is None


def test_what_had_less_is_shown_and_marked_until_there_is_what_has_not(results: dict[str, Result]) -> None:
    old, new = results["old"], results["new"]
    assert (old.patience, old.is_current) == (6.0, False)
    assert (new.patience, new.is_current) == (20.0, True)
    assert _newest([old, new]) == [new] and _newest([old]) == [old]
    (sentence,) = _earlier([old], named=True)
    assert sentence.startswith("§ expert counted as stuck after 6 s") and _earlier([new], named=True) == []
    assert f"note: {TASK} stuck after is 6 s in {old.folder} and 20 s in {new.folder}" in notes(old.folder, new.folder)


def test_a_baseline_gives_way_to_one_of_now(results: dict[str, Result], tmp_path: Path) -> None:
    (old,), (new,) = baselines_of([results["old"]]), baselines_of([results["new"]])
    assert (old.stuck_after_s, old.is_current) == (6.0, False) and new.is_current
    assert updated([old], [new]) == [new] and updated([new], [old]) == [new]
    write_baselines(tmp_path / "baselines.csv", [new])
    (read,) = read_baselines(tmp_path / "baselines.csv")
    assert read.stuck_after_s == 20.0
