# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Result folders that can be shown: what was run is known, and the trials are those of a suite. Loads no torch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.evaluation.agent_fields import BACK_OFFS, ROLLS, SCALES, VELOCITIES
from arcgym.evaluation.check import other_length, problems
from arcgym.evaluation.result_folder import (
    CHANGED,
    CODE,
    COMMIT,
    Row,
    checkpoints_of,
    read_run,
    read_trial_rows,
    result_folders,
)
from arcgym.evaluation.suites import read_suites, split_task
from arcgym.evaluation.task_settings import PATIENCE, PHYSICS_STEP, marks
from arcgym.utils.errors import UsageError

STATE = "critic"
"""Group of observations that holds the simulator's state."""

LARGEST_SHARE = 10
"""Shares of a suite's trials that are shown: all of them to each tenth one."""


@dataclass(frozen=True)
class Result:
    """Trials of one agent in one task."""

    folder: Path
    """Result folder."""

    task: str
    """Registered name, with ``:variant`` behind it or without."""

    run: dict[str, Any]
    """What was run."""

    rows: list[Row]
    """A row a trial."""

    @property
    def suite(self) -> str:
        """Name of the suite."""
        return str(self.run["suite"])

    @property
    def segment(self) -> str:
        """Segment or journey, such as ``Sigmoid``."""
        return split_task(self.task)[0].split("-")[1]

    @property
    def robot(self) -> str:
        """Robot, such as ``Magnetic``."""
        return split_task(self.task)[0].split("-")[2]

    @property
    def method(self) -> str:
        """What was trained and how, as :func:`method_of` names it, or the agent that was not trained."""
        return method_of(self.run, self.task)

    @property
    def limits(self) -> str:
        """Limits on the costs of an episode in training, such as ``tip_force 0.3``."""
        training = (self.run.get("training") or [{}])[0]
        return ", ".join(f"{cost} {limit:g}" for cost, limit in (training.get("limits") or {}).items())

    @property
    def reads_depth(self) -> bool:
        """Whether rules on the actions read the simulator's depth, which the policy itself does not see."""
        return any(inputs["simulator_depth"] for inputs in self.run.get("inputs", {}).values())

    @property
    def sees_state(self) -> bool:
        """Whether the policy sees the simulator's state, the critic's group, as a teacher does."""
        return any(STATE in inputs["sees"] for inputs in self.run.get("inputs", {}).values())

    @property
    def conditions(self) -> str:
        """Name of the condition file, such as ``population_v4``."""
        return read_suites()[self.suite].conditions_of(self.run.get("conditions_sha256")).name

    @property
    def is_current(self) -> bool:
        """Whether trials, steps and patience are those that suite and task have now, not earlier ones."""
        return self.conditions == read_suites()[self.suite].conditions and not self.marks

    @property
    def marks(self) -> str:
        """Marks of physics step and patience, each where the task has another now."""
        return marks(self.run, self.task)

    @property
    def steps(self) -> float:
        """Physics steps a second."""
        steps = PHYSICS_STEP.in_run(self.run, self.task)
        assert steps is not None  # every task has them
        return steps

    @property
    def patience(self) -> float | None:
        """Time without progress after which an episode was stuck [s]."""
        return PATIENCE.in_run(self.run, self.task)

    @property
    def checkpoints(self) -> list[str]:
        """SHA-256 of the checkpoints that ran these trials, each once: those of another task of the run are not."""
        return checkpoints_of(self.run, self.rows)

    @property
    def commit(self) -> str:
        """Commit of the code that ran them, or version and hash of the code of an installation without one."""
        versions = self.run["versions"]
        return str(versions.get(COMMIT) or f"version {versions.get('arcgym')}, code {versions.get(CODE)}")

    @property
    def transitions(self) -> float:
        """Most transitions of a training run; 0 where nothing was trained."""
        return max((one.get("transitions", 0) for one in self.run.get("training", [])), default=0)


def method_of(run: dict[str, Any], task: str) -> str:
    """Return the name of a method: its agent, with ``_paper`` where reward and velocity are the paper's.

    ``_paper_free`` is the paper's reward alone, ``_velocity`` a constant velocity alone, ``_slow6.5`` commands of up to
    6.5 mm/s where the task's go farther, and ``_roll9`` a roll to and fro of 9 rad/s that is added to what it commands,
    ``_roll8_2s`` one in another period than the task's; ``_back45`` goes back at 45 mm/s where a tether no longer comes
    on. Agents without training have their own name.
    """
    changes = run.get("changes", {}).get(task, {})
    constant = any(changes.get(path, [None, None])[1] is not None for path in VELOCITIES)
    if run["agent"] != "checkpoint":
        return str(run["agent"]) + "_velocity" * constant + added_mark(run, task)
    training = (run.get("training") or [{}])[0]
    key = str(training.get("agent") or "unknown")
    name = key.removesuffix("cfg_entry_point").removeprefix("rsl_rl").strip("_") or "ppo"
    reward = changes.get("reward", [None, None])[1]
    suffix = f"_{reward}" + ("" if constant else "_free") if reward else "_velocity" * constant
    return name + suffix + _slow_mark(changes) + added_mark(run, task)


def _slow_mark(changes: dict[str, Any]) -> str:
    """Return ``_slow6.5`` for velocities of up to 6.5 mm/s in place of the task's, and nothing for the task's."""
    used = [changes[path][1] for path in SCALES if path in changes]
    return f"_slow{1000.0 * used[0]:g}" if used else ""


def roll_of(run: dict[str, Any], task: str) -> float:
    """Return the amplitude of the roll to and fro that is added to an agent's commands [rad/s]; 0 without one."""
    return _largest(ROLLS, run, task)


def back_off_of(run: dict[str, Any], task: str) -> float:
    """Return the speed at which a tip goes back whose tether no longer comes on [m/s]; 0 where it does not."""
    return _largest(BACK_OFFS, run, task)


def _largest(paths: Sequence[str], run: dict[str, Any], task: str) -> float:
    """Return the largest value that a run gave some fields of the task; 0 where it gave none."""
    changes = run.get("changes", {}).get(task, {})
    return max((float(changes[path][1] or 0.0) for path in paths if path in changes), default=0.0)


def added_mark(run: dict[str, Any], task: str) -> str:
    """Return the end of an agent's name in tables: what is added to its commands, and nothing where nothing is.

    ``_roll9`` is a roll of 9 rad/s, ``_roll9_2s`` one of 2 s, where the task's period is another. ``_back45`` goes back
    at 45 mm/s, ``_back45_3s`` for 3 s and ``_back45_after6s`` after 6 s, where the task's times are others.
    """
    amplitude, speed = roll_of(run, task), 1000.0 * back_off_of(run, task)
    roll = f"_roll{amplitude:g}" + _time_marks(run, task, roll_period="") if amplitude else ""
    times = _time_marks(run, task, back_off_time="", back_off_after="after")
    return roll + (f"_back{speed:g}{times}" if speed else "")


def _time_marks(run: dict[str, Any], task: str, **words: str) -> str:
    """Return ``_2s`` for each of some times of an action that is 2 s in place of the task's, behind its word."""
    used = {path.rpartition(".")[2]: value for path, (_, value) in run.get("changes", {}).get(task, {}).items()}
    return "".join(f"_{word}{used[field]:g}s" for field, word in words.items() if field in used)


def find_results(folders: Sequence[Path]) -> tuple[list[Result], dict[Path, list[str]]]:
    """Return what can be shown of all result folders below some folders, and why the rest is left out.

    Shown are trials whose code, checkpoint and condition file are known and are those of the suite, all of them or each
    n-th one: those that end early come first, so that another part would be another sample. Of a task whose scope had
    another length then nothing is shown.
    """
    found: list[Result] = []
    left_out: dict[Path, list[str]] = {}
    for path in sorted(dict.fromkeys(path for folder in folders for path in result_folders(folder))):
        try:
            run, rows = read_run(path), read_trial_rows(path)
            wrong = [*_unknown(run), *problems(path, whole=False)]
        except UsageError as error:
            left_out[path] = [str(error)]
            continue
        for task in [] if wrong else sorted({row["task"] for row in rows}):
            result = Result(path, task, run, [row for row in rows if row["task"] == task])
            if other := [*other_length(run, task), *_not_whole(result)]:
                wrong += other
            else:
                found.append(result)
        if wrong:
            left_out[path] = wrong
    return found, left_out


def best(results: Sequence[Result]) -> Result | None:
    """Return the result of several of one cell that says most.

    Those of the suite's present trials and the task's present steps come first, then training seeds count, trials, and
    transitions.
    """

    def weight(one: Result) -> tuple[bool, int, int, float, str]:
        return one.is_current, len(one.checkpoints), len(one.rows), one.transitions, one.folder.name

    return max(results, key=weight, default=None)


def _unknown(run: dict[str, Any]) -> list[str]:
    """Return what a run does not say of itself."""
    versions = run.get("versions", {})
    commit = versions.get(COMMIT)
    found = [] if commit or versions.get(CODE) else ["neither commit nor code is known"]
    found += ["its code has changes that the commit has not"] if commit and commit.endswith(CHANGED) else []
    if run.get("agent") == "checkpoint" and not run.get("training"):
        found.append("what its checkpoint was trained with is not known")
    return found


def _not_whole(result: Result) -> list[str]:
    """Return a reason unless there are all trials of the suite, or each n-th of them from the first on."""
    conditions = read_suites()[result.suite].conditions_of(result.run.get("conditions_sha256"))
    numbers = [trial.trial for trial in conditions.trials]
    if {row["trial"] for row in result.rows} in [set(numbers[::n]) for n in range(1, LARGEST_SHARE + 1)]:
        return []
    return [f"{result.task} has {len(result.rows)} trials, neither all nor each n-th of them"]
