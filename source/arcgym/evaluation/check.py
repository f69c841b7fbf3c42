# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Check of a result folder before it is published. Loads neither torch nor Warp."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import yaml

from arcgym.evaluation.result_folder import (
    CHANGED,
    COMMIT,
    DROPPED,
    HASH,
    TEXTS,
    Row,
    read_run,
    read_trial_rows,
)
from arcgym.evaluation.suites import Suite, read_suites, split_task
from arcgym.evaluation.task_settings import SCOPE_LENGTH
from arcgym.evaluation.trials import COLUMNS, Conditions, read_conditions
from arcgym.utils.untrained import UNTRAINED

AGENTS_OWN = (
    *("observations", "extra_observations", "reward", "rewards", "costs", "curriculum", "viewer"),
    *("is_finite_horizon", "scale_rewards_by_dt", "compute_final_obs"),
    *("actions.tip.roll_period", "actions.base.roll_period"),
    *("actions.tip.back_off_after", "actions.tip.back_off_time"),
)
"""Fields of the environment, with all below them, that are the agent's: all others make a task what it is."""

ROOM = ("sim.contact.capacity", "sim.contact.patch_capacity")
"""Fields of the environment that give contacts room, and change nothing where they had enough."""

OWN_UP_TO = {
    "actions.tip.forward_velocity": 0.045,
    "actions.capsule.forward_velocity": 0.05,
    "actions.base.insertion_velocity": 0.05,
    "actions.tip.roll_amplitude": 18.0,
    "actions.base.roll_amplitude": 9.0,
    "actions.tip.back_off_velocity": 0.045,
    "actions.tip.linear_scale": 0.045,
    "actions.capsule.linear_scale": 0.05,
    "actions.base.insertion_scale": 0.05,
}
"""Fields that are the agent's up to a value. A constant velocity: the largest that actions command [m/s]. A smaller
scale of velocities than the task's: a policy that is slow might have been so by smaller actions [m/s]. A roll to and
fro: the largest amplitude that scripted experts draw, who are not the task's either (``roll`` of
:class:`arcgym.experts.PullExpert` for a tip, ``twist`` of :class:`arcgym.experts.PushExpert` for a base) [rad/s]. Going
back where a tether no longer comes on: the largest velocity that actions command [m/s]."""

VELOCITIES = tuple(path for path in OWN_UP_TO if path.endswith((".forward_velocity", ".insertion_velocity")))
"""Those of a constant velocity, which tables name."""

BACK_OFFS = tuple(path for path in OWN_UP_TO if path.endswith(".back_off_velocity"))
"""Those of going back where a tether no longer comes on, which tables name."""

ROLLS = tuple(path for path in OWN_UP_TO if path.endswith(".roll_amplitude"))
"""Those of a roll to and fro, which tables name."""

SCALES = tuple(path for path in OWN_UP_TO if path.endswith("_scale"))
"""Those of the velocities that actions command, which tables name as well."""

SWITCH = "enabled"
"""Field of an effect's configuration that says whether there is the effect at all."""

SEEDS = 3
"""Training seeds that are asked for where a condition file has groups."""

KEPT_UNSEEN = ("population", "ct")
"""Suites whose patients nothing may be trained on."""

KEPT_FROM_ITS_POLICIES = ("cross_colon",)
"""Suites whose patients the policies evaluated in them must not have been trained on."""

SHARES = ("s_c", "coverage")
"""Columns from 0 to 1, beside those that end in ``_rate``."""

POSITIVE = ("force", "impulse", "time", "seconds", "strain", "tension", "stretch", "friction", "stiffness", "length")
"""Words in the names of columns that cannot be negative."""

BASIC = ("task", "agent", *COLUMNS, "success", "end", "reward", "seconds")
"""Columns that every row must have."""


def problems(path: Path, whole: bool = True) -> list[str]:
    """Return what is wrong with a submission, a line each; none if it can be published.

    Trials must be those of the suite's condition file, each of them once, with possible values.

    Args:
        path: The folder.
        whole: Whether it is a submission: with all tasks, trials and training seeds of the suite, and without rules on
            actions that read the simulator's depth.

    Raises:
        UsageError: It is no result folder.
    """
    run, rows, suites = read_run(path), read_trial_rows(path), read_suites()
    suite = suites.get(str(run.get("suite")))
    if suite is None:
        return [f"suite is '{run.get('suite')}', expected one of {', '.join(suites)}"]
    conditions = suite.conditions_of(run.get("conditions_sha256"))
    found = [*_run_problems(run, conditions, suite), *_row_problems(rows, conditions), *_other_tasks(rows, suite)]
    outdated = [*_outdated(conditions, suite), *(line for task in _tasks(rows) for line in other_length(run, task))]
    unfit = [*outdated, *_unfit_to_compete(run, rows, conditions), *_silent(run, rows)]
    return found + [*unfit, *_missing_trials(rows, conditions, suite)] * whole


def _run_problems(run: dict[str, Any], conditions: Conditions, suite: Suite) -> list[str]:
    found = []
    if run.get("conditions_sha256") != conditions.sha256:
        found.append(f"conditions are not those of {conditions.name}: the hash of the condition file differs")
    if run.get("agent") not in ("checkpoint", *UNTRAINED):
        found.append(f"agent is '{run.get('agent')}', expected checkpoint, {', '.join(UNTRAINED)}")
    if run.get("agent") == "checkpoint" and not run.get("checkpoint_sha256"):
        found.append("checkpoint_sha256 is missing: the checkpoint cannot be identified")
    found += _seen_in_training(run, str(run.get("suite")))
    for task, contacts in run.get(DROPPED, {}).items():
        found.append(f"{contacts} contacts of {task} found no room: run it with a larger env.sim.contact.capacity")
    given = [text for text in run.get("overrides", []) if text not in suite.overrides and not text.startswith("agent.")]
    tasks = list(run.get("changes", {}))
    more = [text for text in given if not (_is_agents_own(text) or _is_as_registered(text, tasks, suite))]
    if more:
        found.append(f"overrides {more} change the task: publish it as a variant of its own")
    for task, changes in run.get("changes", {}).items():
        allowed = dict(map(_path_and_value, suite.overrides_of(task)))
        for path, (registered, used) in changes.items():
            own = is_agents(path, used) or _is_of_nothing(task, path, {*changes, *allowed})
            if not own and _text(used) != allowed.get(path, "").lower():
                found.append(f"{task} was run with {path} = {used}, which changes the task ({registered})")
    return found


def _text(value: Any) -> str:
    """Return a value as an override writes it: ``[all]`` for a list of one name."""
    return str(value).replace("'", "").replace(", ", ",").lower()


def _path_and_value(override: str) -> tuple[str, str]:
    """Return the two of an override, ``env.path=value``."""
    path, _, value = override.removeprefix("env.").partition("=")
    return path, value


def _is_agents_own(override: str) -> bool:
    """Return whether an override gives a field that is the agent's to choose."""
    path, value = _path_and_value(override)
    return is_agents(path, yaml.safe_load(value))


def _outdated(conditions: Conditions, suite: Suite) -> list[str]:
    """Return a problem for trials of an earlier condition file, whose patients are others now."""
    if conditions.name == suite.conditions:
        return []
    return [f"trials are of {conditions.name}, an earlier version of {suite.conditions}: evaluate again"]


def other_length(run: dict[str, Any], task: str) -> list[str]:
    """Return a problem if the scope of a task has another length now; none where ``changes`` of the run say so."""
    if SCOPE_LENGTH.is_present(run, task) or SCOPE_LENGTH.field in run.get("changes", {}).get(task, {}):
        return []
    length = SCOPE_LENGTH.as_text(SCOPE_LENGTH.in_run(run, task))
    now = SCOPE_LENGTH.as_text(SCOPE_LENGTH.registered(task))
    return [f"{task} was run with a scope of {length}, and has a scope of {now} now: evaluate again"]


def _is_as_registered(override: str, tasks: Sequence[str], suite: Suite) -> bool:
    """Return whether an override gives a field that the suite leaves alone its registered value.

    A policy brings along the settings of its training, and needs it where a default has changed since then.
    """
    from arcgym.utils.registry import load_cfg_from_registry

    path, value = _path_and_value(override)
    if path in ROOM:
        return True
    for task in tasks:
        found = load_cfg_from_registry(split_task(task)[0], "env_cfg_entry_point")
        for name in path.split("."):
            found = found.get(name, "") if isinstance(found, dict) else getattr(found, name, "")
        of_suite = dict(map(_path_and_value, suite.overrides_of(task)))
        if path in of_suite or (str(found).lower() != value.lower() and found != yaml.safe_load(value)):
            return False
    return bool(tasks)


def _is_of_nothing(task: str, path: str, changed: set[str]) -> bool:
    """Return whether a field is one of an effect that is off in the registered task, and that nothing switches on.

    Policies bring along the settings that such effects had when they were trained.
    """
    effect, _, name = path.rpartition(".")
    if name == SWITCH or f"{effect}.{SWITCH}" in changed:
        return False
    from arcgym.utils.registry import load_cfg_from_registry

    found = load_cfg_from_registry(split_task(task)[0], "env_cfg_entry_point")
    for part in effect.split(".") if effect else ():
        found = getattr(found, part, None)
    return getattr(found, SWITCH, None) is False


def _unfit_to_compete(run: dict[str, Any], rows: list[Row], conditions: Conditions) -> list[str]:
    """Return a problem for too few training seeds, rules that know more than the policy, and code that nobody has."""
    commit = str(run.get("versions", {}).get(COMMIT, ""))
    found = [f"was run by code that is not that of its commit: {commit}"] if commit.endswith(CHANGED) else []
    checkpoints, wanted = len(set(run.get("checkpoint_sha256", []))), min(conditions.groups, SEEDS)
    if run.get("agent") == "checkpoint" and 0 < checkpoints < wanted:
        found.append(f"has {checkpoints} checkpoint(s), expected {wanted} training seeds: {conditions.name} has groups")
    ran = {str(row.get("agent")) for row in rows}
    named = zip(run.get("checkpoint", []), run.get("checkpoint_sha256", []), strict=False)
    idle = [path for path, digest in named if path not in ran and digest[:HASH] not in ran]
    found += [f"names the checkpoint {path}, which ran no trial" for path in idle]
    for task, inputs in run.get("inputs", {}).items():
        if inputs["simulator_depth"]:
            found.append(f"{task} was run with rules on actions that read the simulator's depth")
    return found


def _silent(run: dict[str, Any], rows: list[Row]) -> list[str]:
    """Return a problem for each task of which a checkpoint's run does not say how it was run and what was seen."""
    asked = {"changes": "with what settings it was run", "inputs": "what its policy sees"}
    tasks = _tasks(rows) if run.get("agent") == "checkpoint" else []
    return [
        f"{task}: run.json does not say {what}, '{name}' is missing"
        for name, what in asked.items()
        for task in tasks
        if task not in run.get(name, {})
    ]


def _tasks(rows: list[Row]) -> list[str]:
    return sorted({row["task"] for row in rows if "task" in row})


def is_agents(path: str, used: Any) -> bool:
    """Return whether a field of the environment, by its path, is the agent's to choose, with the value used.

    So is the room for contacts.
    """
    if path in OWN_UP_TO:
        return used is None or (isinstance(used, int | float) and abs(used) <= OWN_UP_TO[path])
    return path in ROOM or any(path == own or path.startswith(f"{own}.") for own in AGENTS_OWN)


def _seen_in_training(run: dict[str, Any], suite: str) -> list[str]:
    """Return a problem where a policy was trained on patients that are for testing."""
    suites = read_suites()
    kept = [*KEPT_UNSEEN, *([suite] if suite in KEPT_FROM_ITS_POLICIES else [])]
    unseen = {trial.patient for name in kept for trial in read_conditions(suites[name].conditions_path).trials}
    seen = [name for name in _patients(run.get("trained_on", [])) if name in unseen or name == "population:test"]
    return [f"was trained on {', '.join(sorted(set(seen)))}, kept unseen for tests"] if seen else []


def _patients(trained_on: Sequence[Any]) -> list[str]:
    """Return the single patients of configurations' ``usd_path``: without their gas, and by folder and file."""
    texts = [text for names in trained_on for text in ([names] if isinstance(names, str) else names or [])]
    found = []
    for text in texts:
        population, colon, members = text.partition(":")
        if colon and "/" not in population:
            found += [f"{population}:{member.partition('*')[0]}" for member in members.split(",")]
        else:
            found.append("/".join(Path(text).parts[-2:]))
    return found


def _row_problems(rows: list[Row], conditions: Conditions) -> list[str]:
    if not rows:
        return ["trials.csv has no row"]
    lacking = [name for name in BASIC if name not in rows[0]]
    if lacking:
        return [f"trials.csv lacks the columns {', '.join(lacking)}"]
    trials = {trial.trial: trial for trial in conditions.trials}
    found, seen = [], set()
    for row in rows:
        label = f"trial {row['trial']} of {row['task']}"
        trial = trials.get(row["trial"])
        if (row["task"], row["trial"]) in seen:
            found.append(f"{label} is there twice")
        seen.add((row["task"], row["trial"]))
        if trial is None or (row["patient"], row["seed"], row["group"]) != (trial.patient, trial.seed, trial.group):
            found.append(f"{label} has another patient, seed or group than the condition file")
        if row["success"] not in (0, 1) or (row["success"] == 1) != (row["end"] == "success"):
            found.append(f"{label} says success {row['success']} and end '{row['end']}'")
        if row.get("progress") is not None and not 0.0 <= row["progress"] <= 1.0:
            found.append(f"{label} has a progress of {row['progress']}, expected 0 to 1")
        if row["success"] == 1 and row.get("progress", 1.0) < _least_progress(row["task"]):
            found.append(f"{label} succeeded with a progress of {row['progress']}")
        found += [f"{label} has {name} = {value}, {why}" for name, value, why in _impossible(row)]
    return found


def _least_progress(task: str) -> float:
    """Return the least progress with which a task succeeds.

    The cecum is reached halfway from its valve to its end: at 0.975 of the way in the shortest colon (``ct_2``, 1.19 m)
    and at 0.977 or more in the patients of the split ``test``.
    """
    return 0.97 if "-Cecum-" in task else 0.999


def _impossible(row: Row) -> Iterator[tuple[str, float | str, str]]:
    """Yield the columns of a row whose value cannot be, with why."""
    for name, value in row.items():
        if not isinstance(value, float):
            if isinstance(value, str) and name not in TEXTS:
                yield name, value, "expected a number"
            continue
        if not math.isfinite(value):
            if row["end"] != "non_finite":  # an episode whose state broke may say so
                yield name, value, "expected a finite number"
        elif (name in SHARES or name.endswith("_rate")) and not -1e-6 <= value <= 1.0 + 1e-6:
            yield name, value, "expected 0 to 1"
        elif value < -1e-6 and any(word in name for word in POSITIVE):
            yield name, value, "expected no negative number"
        elif name.startswith("mean_") and value > (most := row.get(f"max_{name[5:]}", math.inf)) * (1 + 1e-5):
            yield name, value, f"above the largest, {most}"
        elif name.startswith("max_") and value > (peak := row.get(f"peak_{name[4:]}", math.inf)) * (1 + 1e-5) + 1e-6:
            yield name, value, f"above the peak, {peak}"


def _other_tasks(rows: list[Row], suite: Suite) -> list[str]:
    """Return a problem for each task that is not the suite's."""
    own = {task for robot in _robots(rows) for task in suite.tasks(robot)}
    return [f"{task} is no task of the suite" for task in _tasks(rows) if task not in own]


def _robots(rows: list[Row]) -> list[str]:
    return sorted({split_task(task)[0].split("-")[-1] for task in _tasks(rows)})


def _missing_trials(rows: list[Row], conditions: Conditions, suite: Suite) -> list[str]:
    """Return a problem for each task that lacks trials."""
    found = []
    for robot in _robots(rows):
        for task in suite.tasks(robot):
            done = {row["trial"] for row in rows if row["task"] == task}
            missing = [trial.trial for trial in conditions.trials if trial.trial not in done]
            if missing:
                found.append(f"{task} lacks {len(missing)} of {len(conditions.trials)} trials, first {missing[0]}")
    return found
