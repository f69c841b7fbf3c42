# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Comparing and merging of result folders."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest
from paper_results import RUN, TASKS, changed, result

from arcgym.cli.main import main
from arcgym.evaluation.check import problems
from arcgym.evaluation.compare import compare, notes
from arcgym.evaluation.merge import merge
from arcgym.evaluation.result_folder import ResultFolder
from arcgym.evaluation.suites import read_suites
from arcgym.utils.errors import UsageError


def test_difference_is_of_the_same_trials(tmp_path: Path) -> None:
    table = compare(result(tmp_path / "a"), result(tmp_path / "b", seconds=7.0))
    assert set(table) == set(TASKS)
    of = table[TASKS[0]]["seconds"]
    assert (of.value, of.low, of.high) == pytest.approx((2.0, 2.0, 2.0))


def test_other_versions_are_told(tmp_path: Path, capsys) -> None:
    runs = [{**RUN, "versions": {"newton": "1.8.0", "arcgym commit": commit}} for commit in ("abc", "def")]
    words = [str(result(tmp_path / name, run=run)) for name, run in zip("ab", runs, strict=True)]
    main(["results", "compare", *words])
    out = capsys.readouterr().out
    assert f"note: arcgym commit is abc in {words[0]} and def in {words[1]}" in out and "newton" not in out


def test_all_that_may_make_a_difference_beside_the_agents_is_told(tmp_path: Path) -> None:
    """A reward is the agent's own, a start is not."""
    first = result(tmp_path / "a", run=changed(TASKS[0], reward=["shaped", "paper"]) | {"machine": "a"})
    easier = changed(TASKS[0], start=["segment", "rest"]) | {"machine": "b"}
    second = result(tmp_path / "b", run=easier, trials=slice(0, 3))
    assert notes(first, second) == [
        f"note: machine is a in {first} and b in {second}",
        f"note: {TASKS[0]} start is None in {first} and rest in {second}",
        f"note: 12 trials are of both, of 120 in {first} and 12 in {second}",
    ]
    assert notes(first, first) == []
    older, newer = ({"physics_hz": {TASKS[0]: steps}, "changes": {TASKS[0]: {}}} for steps in (480.0, 240.0))
    first, second = (result(tmp_path / name, run=RUN | of) for name, of in (("c", older), ("d", newer)))
    assert notes(first, second) == [f"note: {TASKS[0]} physics step is 1/480 s in {first} and 1/240 s in {second}"]
    with pytest.raises(UsageError, match="'physics_hz' in run.json"):
        merge([first, second], tmp_path / "both")


def test_the_table_says_which_is_subtracted(tmp_path: Path, capsys) -> None:
    few = slice(0, 3)
    first, second = result(tmp_path / "a", trials=few), result(tmp_path / "b", trials=few)
    assert main(["results", "compare", str(first), str(second)]) == 0
    assert capsys.readouterr().out.startswith(f"{second} minus {first}, the same trials:\n\n| task |")


def test_other_trials_cannot_be_compared(tmp_path: Path) -> None:
    other = result(tmp_path / "b", run={**RUN, "conditions_sha256": "other"})
    with pytest.raises(UsageError, match="conditions_sha256"):
        compare(result(tmp_path / "a"), other)


def test_parts_of_two_machines_make_a_whole(tmp_path: Path) -> None:
    parts = [result(tmp_path / "a", trials=slice(0, 16)), result(tmp_path / "b", trials=slice(15, 30))]
    assert main(["results", "merge", str(tmp_path / "all"), *map(str, parts)]) == 0
    assert main(["results", "check", str(tmp_path / "all")]) == 0
    parquet = pytest.importorskip("pyarrow.parquet").read_table(tmp_path / "all" / "trials.parquet")
    assert sorted(set(parquet["trial"].to_pylist())) == list(range(30))


def test_contacts_without_room_are_added_up_and_refused(tmp_path: Path) -> None:
    of = [{TASKS[0]: 5}, {TASKS[0]: 2, TASKS[1]: 1}]
    runs = [{**RUN, "dropped_contacts": counts, "overrides": ["env.sim.contact.capacity=60"]} for counts in of]
    parts = [result(tmp_path / name, run=run) for name, run in zip("ab", runs, strict=True)]
    merge(parts, tmp_path / "all")
    assert problems(tmp_path / "all") == [
        f"{contacts} contacts of {task} found no room: run it with a larger env.sim.contact.capacity"
        for task, contacts in ((TASKS[0], 7), (TASKS[1], 1))
    ]


def test_a_checkpoint_has_one_name_wherever_it_lies(tmp_path: Path) -> None:
    """One machine has it in /a, the other in /b: it is one training run, and the trial that both ran is the same."""
    ours = {**RUN, "checkpoint": ["/a/1.pt", "/a/2.pt", "/a/3.pt"]}
    theirs = {**RUN, "checkpoint": ["/b/1.pt", "/b/2.pt", "/b/3.pt"]}
    first = result(tmp_path / "a", run=ours, trials=slice(0, 16), every={"agent": "/a/2.pt"})
    second = result(tmp_path / "b", run=theirs, trials=slice(15, 30), every={"agent": "/b/2.pt"})
    rows = merge([first, second], tmp_path / "all").rows
    assert len(rows) == 120 and {row["agent"] for row in rows} == {"/a/2.pt"}
    assert ResultFolder(first, theirs).names == {f"/b/{k}.pt": f"/a/{k}.pt" for k in (1, 2, 3)}
    found = problems(tmp_path / "all")
    assert found[4:] == [f"names the checkpoint /a/{k}.pt, which ran no trial" for k in (1, 3)]
    assert all("has 1 checkpoint(s), expected 3 training seeds" in line for line in found[:4])


def test_two_results_of_one_trial_are_refused(tmp_path: Path) -> None:
    parts = [str(result(tmp_path / "a")), str(result(tmp_path / "b", seconds=6.0))]
    with pytest.raises(SystemExit):
        main(["results", "merge", str(tmp_path / "all"), *parts])


def test_what_the_parts_changed_is_known_of_the_whole(tmp_path: Path, capsys) -> None:
    """The second machine ran a task of its own more easily; a third ran the same task as it is."""
    first = {**RUN, "changes": {task: {} for task in TASKS if task != TASKS[1]}}
    easier = {**RUN, "changes": {TASKS[1]: {"start": ["segment", "rest"]}}}
    parts = [result(tmp_path / "a", run=first), result(tmp_path / "b", run=easier)]
    assert main(["results", "merge", str(tmp_path / "all"), *map(str, parts)]) == 0
    assert main(["results", "check", str(tmp_path / "all")]) == 1
    assert f"{TASKS[1]} was run with start = rest" in capsys.readouterr().out
    other = result(tmp_path / "c", run={**RUN, "changes": {TASKS[1]: {}}})
    with pytest.raises(SystemExit):
        main(["results", "merge", str(tmp_path / "all"), str(other)])
    assert "with other settings" in capsys.readouterr().err


def test_a_checkpoint_of_a_task_without_a_robot_asks_for_the_tasks(tmp_path: Path, monkeypatch, capsys) -> None:
    (tmp_path / "model_1.pt").touch()
    monkeypatch.setattr("arcgym.rl.params.read_params", lambda _: SimpleNamespace(task="My-Rectum-v0"))
    with pytest.raises(SystemExit):
        main(["evaluate", "--agent", str(tmp_path / "model_1.pt"), "--out", str(tmp_path / "out")])
    assert "was trained in My-Rectum-v0, which no suite has: give --tasks My-Rectum-v0" in capsys.readouterr().err


def test_trials_of_an_earlier_version_cannot_be_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = read_suites()["population"].conditions_path.with_stem("population_v2")
    words = ["--agent", "zero", "--robot", "Magnetic", "--suite", "population", "--out", str(tmp_path / "a")]
    with pytest.raises(SystemExit):
        main(["evaluate", *words, "--conditions", str(file)])
    assert "the same trials on the present ones are population_v4" in capsys.readouterr().err
    assert not (tmp_path / "a").exists()
