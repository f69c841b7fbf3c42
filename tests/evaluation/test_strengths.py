# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The table of robustness variants, from made-up trials."""

from __future__ import annotations

from pathlib import Path

import pytest

from arcgym.evaluation.page import write_page
from arcgym.evaluation.result_folder import ResultFolder
from arcgym.evaluation.strengths import strengths_tables
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.summary import report


def trial(variant: str, number: int, progress: float) -> dict:
    task = "ARC-LeftColon-Magnetic" + (f":{variant}" if variant else "")
    success = int(progress == 1.0)
    return {"task": task, "agent": "a", "trial": number, "group": 0, "success": success, "progress": progress}


def test_each_kind_is_a_line_with_what_each_strength_changes_in_the_same_trials() -> None:
    """Two trials: blur of strength 3 takes 0.5 of the progress of each, strength 1 nothing; 2 has not been run."""
    rows = [trial("none", 0, 1.0), trial("none", 1, 0.75)]
    rows += [trial("blur_1", 0, 1.0), trial("blur_1", 1, 0.75), trial("blur_3", 0, 0.5), trial("blur_3", 1, 0.25)]
    (table,) = strengths_tables(rows)
    assert table.title == "ARC-LeftColon-Magnetic, a: success 50 (9–91) % in 2 trials without trouble"
    changes = ["+0.00 (+0.00 to +0.00)", "", "-0.50 (-0.50 to -0.50)"]
    assert table.lines == [["blur", "50 (9–91)", "no trial", "0 (0–66)", *changes]]
    assert report(rows).endswith(f"| {' | '.join(table.lines[0])} |\n")


def test_kinds_are_in_the_order_of_the_suite_and_a_checkpoint_is_named_in_short() -> None:
    rows = [trial("soft_1", 0, 0.5), trial("dim_2", 0, 0.5), trial("fluid_3", 0, 0.5), trial("none", 0, 0.5)]
    (table,) = strengths_tables([{**row, "agent": "/home/me/runs/a/model_9.pt"} for row in rows])
    assert [line[0] for line in table.lines] == ["fluid", "dim", "soft"]
    assert table.title.startswith("ARC-LeftColon-Magnetic, a/model_9.pt: success 0 (0–79) % in 1 trials")


def test_a_trial_without_its_unspoiled_twin_does_not_count_as_a_change() -> None:
    (table,) = strengths_tables([trial("none", 0, 0.5), trial("soft_2", 0, 0.25), trial("soft_2", 7, 1.0)])
    assert table.lines[0][-3:] == ["", "-0.25 (-0.25 to -0.25)", ""]


def test_other_suites_have_no_such_table() -> None:
    rows = [trial("", 0, 1.0), trial("none", 0, 1.0), trial("stiff_nu045", 0, 1.0)]
    assert strengths_tables(rows) == []
    assert report(rows).count("| task |") == 1 and "kind" not in report(rows)


@pytest.mark.filterwarnings("error::UserWarning")
def test_the_page_has_room_for_all_variants(tmp_path: Path) -> None:
    """Forty tasks: a figure with a line each, and no legend that leaves no room for its axes."""
    folder = ResultFolder(tmp_path, {"suite": "robustness", "agent": "expert"})
    for variant in read_suites()["robustness"].variants:
        folder.add({**trial(variant, 0, 0.5), "end": "stuck", "reward": 1.0, "seconds": 5.0, "p95_tip_force": 1.0})
    text = write_page(tmp_path).read_text()
    assert "<th>progress, 3 less none</th>" in text and "<td>collapsed</td>" in text
