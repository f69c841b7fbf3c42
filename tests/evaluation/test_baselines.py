# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Baselines: rows of a small file, replaced by those of result folders, and the tables made from them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from result_folders import TASK, write_result_folder

from arcgym.evaluation.baselines import FIGURES, baselines_of, read_baselines, updated, write_baselines
from arcgym.evaluation.results import find_results
from arcgym.utils.errors import UsageError

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "scripts" / "tools" / "baseline_tables.py"


def folder(path: Path, agent: str, successes: int = 0, every: int = 1, **run) -> Path:
    """The rectum's 30 trials, or each n-th of them, by an agent that was not trained."""
    untrained = {"agent": agent, "checkpoint": [], "checkpoint_sha256": [], "training": [], "trained_on": []}
    return write_result_folder(path, successes, every=every, **untrained | run)


def baselines(*folders: Path):
    return baselines_of(find_results(folders)[0])


def tables(*words: str) -> list[str]:
    done = subprocess.run([sys.executable, str(SCRIPT), *words], capture_output=True, text=True, check=True, timeout=60)
    return done.stdout.splitlines()


def test_the_page_has_the_rows_of_the_file() -> None:
    page = (ROOT / "docs" / "baselines.md").read_text()
    between = page[
        page.index("<!-- baselines -->\n") + len("<!-- baselines -->\n") : page.index("<!-- end of baselines -->")
    ]
    assert between.splitlines() == tables()


def test_rows_of_the_file_stay_beside_those_of_folders(tmp_path: Path) -> None:
    """Zero from the file, random from a folder: 3 of 30 arrive, Wilson 3 to 26 %."""
    known, new = folder(tmp_path / "known", "zero"), folder(tmp_path / "new" / "random", "random", 3)
    write_baselines(tmp_path / "baselines.csv", baselines(known))
    of_other = {"versions": {"arcgym commit": "def5678"}}
    folder(tmp_path / "new" / "expert", "expert", 30, every=10, **of_other)
    lines = tables(str(tmp_path / "new"), "--baselines", str(tmp_path / "baselines.csv"))
    rows = [line for line in lines if line.startswith(f"| `{TASK}`")]
    assert rows == [
        f"| `{TASK}` | zero | 30 | 0 (0–11) | 0.50 (0.50–0.50) | 2.0 (2.0–2.0) |",
        f"| `{TASK}` | random | 30 | 10 (3–26) | 0.50 (0.50–0.50) | 2.0 (2.0–2.0) |",
        f"| `{TASK}` | expert | 3 | 100 (44–100) | 1.00 (1.00–1.00) | 2.0 (2.0–2.0) |",
    ]
    assert "zero, random: commit abc1234; a machine. expert: commit def5678; a machine." in lines
    assert new.is_dir()


def test_a_row_gives_way_to_as_many_trials_and_to_no_fewer(tmp_path: Path) -> None:
    known = baselines(folder(tmp_path / "a", "expert", 15, every=2))
    fewer, more = (baselines(folder(tmp_path / str(every), "expert", 30, every=every)) for every in (3, 1))
    assert [one.trials for one in updated(known, fewer)] == [15]
    assert [one.trials for one in updated(known, more)] == [30]
    assert updated(known, baselines(folder(tmp_path / "b", "expert", 0, every=2)))[0].figures["success"].value == 0.0


def test_a_row_of_earlier_trials_gives_way_to_fewer_present_ones(tmp_path: Path) -> None:
    of = {"task": "ARC-LeftColon-Magnetic", "suite": "population"}
    old = baselines(folder(tmp_path / "old", "expert", **of, conditions_name="population_v2"))
    new = baselines(folder(tmp_path / "new", "expert", every=10, **of))
    assert [one.conditions for one in (*old, *new)] == ["population_v2", "population_v4"]
    assert updated(old, new) == new == updated(new, old)
    write_baselines(tmp_path / "baselines.csv", old)
    last = tables("--baselines", str(tmp_path / "baselines.csv"))[-1]
    assert last == "Commit abc1234; a machine; trials of population_v2, an earlier version."


def test_a_row_of_another_physics_step_says_so_and_gives_way_to_the_present_one(tmp_path: Path) -> None:
    """Files without the column are of steps of 1/480 s."""
    old = baselines(folder(tmp_path / "old", "expert", physics_hz={}))
    new = baselines(folder(tmp_path / "new", "expert", every=10))
    assert updated(old, new) == new == updated(new, old)
    write_baselines(tmp_path / "baselines.csv", old)
    last = "Commit abc1234; a machine; physics steps of 1/480 s, an earlier default."
    assert tables("--baselines", str(tmp_path / "baselines.csv"))[-1] == last
    assert read_baselines(tmp_path / "baselines.csv")[0].physics_hz == 480.0


def test_a_row_gives_way_to_none_without_its_figures(tmp_path: Path) -> None:
    (known,) = baselines(folder(tmp_path / "a", "expert", 30))
    (new,) = baselines(folder(tmp_path / "b", "expert", 0))
    new.figures.pop("progress")
    assert updated([known], [new]) == [known]


@pytest.mark.parametrize(
    ("run", "every", "reason"),
    [
        ({}, 11, "has 3 trials, neither all nor each n-th of them"),
        ({"overrides": ["env.start=rest"]}, 1, "change the task"),
        ({"versions": {}}, 1, "neither commit nor code is known"),
    ],
)
def test_what_is_no_baseline_of_the_suite_is_left_out_with_the_reason(
    tmp_path: Path, run: dict, every: int, reason: str
) -> None:
    path = folder(tmp_path / "all" / "a", "random", every=every, **run)
    lines = tables(str(tmp_path / "all"), "--baselines", str(tmp_path / "baselines.csv"))
    assert lines[0].startswith(f"left out: {path}: ") and reason in lines[0]
    assert not [line for line in lines if line.startswith("| `")]


def test_a_trained_policy_is_no_baseline(tmp_path: Path) -> None:
    assert baselines(write_result_folder(tmp_path / "a", 30)) == []


def test_the_file_gives_back_what_was_written(tmp_path: Path) -> None:
    """Four digits: 1/3 comes back as 0.3333, in the table 0.33 either way."""
    (one,) = baselines(folder(tmp_path / "a", "random", 10))
    write_baselines(tmp_path / "baselines.csv", [one])
    (back,) = read_baselines(tmp_path / "baselines.csv")
    assert (back.key, back.trials, back.commit, back.machine) == (one.key, 30, "abc1234", "a machine")
    assert set(back.figures) == {"success", "progress", "seconds"} < set(FIGURES)
    assert back.figures["success"].value == 0.3333


def test_an_unknown_suite_is_named(tmp_path: Path) -> None:
    (one,) = baselines(folder(tmp_path / "a", "random"))
    file = tmp_path / "baselines.csv"
    write_baselines(file, [one])
    file.write_text(file.read_text().replace("paper,", "papre,"))
    with pytest.raises(UsageError, match="has random in 'papre'"):
        read_baselines(file)
