# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Check of a result folder before it is published. Loads neither torch nor Warp."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from arcgym.evaluation.agent_fields import CONTACT_ROOM, is_agents
from arcgym.evaluation.resolved_cfg import resolved
from arcgym.evaluation.result_folder import (
    CHANGED,
    COMMIT,
    DROPPED,
    HASH,
    UNKNOWN,
    Row,
    checkpoints_of,
    read_run,
    read_trial_rows,
)
from arcgym.evaluation.row_checks import row_problems
from arcgym.evaluation.suites import Suite, read_suites, split_task
from arcgym.evaluation.task_settings import SCOPE_LENGTH
from arcgym.evaluation.trials import Conditions, read_conditions
from arcgym.utils.untrained import UNTRAINED

SWITCH = "enabled"
"""Field of an effect's configuration that switches the effect on."""

SEEDS = 3
"""Training seeds that are asked for where a condition file has groups."""

KEPT_UNSEEN = ("population", "ct")
"""Suites whose patients nothing may be trained on."""

KEPT_FROM_ITS_POLICIES = ("cross_colon",)
"""Suites whose patients the policies evaluated in them must not have been trained on."""


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
    found = [*_run_problems(run, conditions, suite), *row_problems(rows, conditions), *_other_tasks(rows, suite)]
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
            own = is_agents(path, used) or _is_of_nothing(task, path, {*changes, *allowed}, suite)
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
    return is_agents(path, _plain(value))


def _plain(value: str) -> Any:
    """Return the value of an override, in which ``1e-2`` is a number, too."""
    found = yaml.safe_load(value)
    try:
        return float(found) if isinstance(found, str) else found
    except ValueError:
        return found


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
    if path in CONTACT_ROOM:
        return True
    for task in tasks:
        found = load_cfg_from_registry(split_task(task)[0], "env_cfg_entry_point")
        for name in path.split("."):
            found = found.get(name, "") if isinstance(found, dict) else getattr(found, name, "")
        of_suite = dict(map(_path_and_value, suite.overrides_of(task)))
        if path in of_suite or (str(found).lower() != value.lower() and found != _plain(value)):
            return False
    return bool(tasks)


def _is_of_nothing(task: str, path: str, changed: set[str], suite: Suite) -> bool:
    """Return whether a field is one of an effect that is off in the suite's task, and that nothing switches on.

    Policies bring along the settings that such effects had when they were trained.
    """
    effect, _, name = path.rpartition(".")
    if name == SWITCH or f"{effect}.{SWITCH}" in changed:
        return False
    from arcgym.utils.hydra import apply_overrides
    from arcgym.utils.registry import load_cfg_from_registry

    found = load_cfg_from_registry(split_task(task)[0], "env_cfg_entry_point")
    apply_overrides({"env": found}, suite.overrides_of(task))
    found = resolved(found)
    for part in effect.split(".") if effect else ():
        found = getattr(found, part, None)
    return getattr(found, SWITCH, None) is False


def _unfit_to_compete(run: dict[str, Any], rows: list[Row], conditions: Conditions) -> list[str]:
    """Return a problem for too few training seeds, rules that know more than the policy, and code that nobody has."""
    commit = str(run.get("versions", {}).get(COMMIT, ""))
    found = [f"was run by code that is not that of its commit: {commit}"] if commit.endswith(CHANGED) else []
    wanted, ran = min(conditions.groups, SEEDS), {str(row.get("agent")) for row in rows}
    for task in _tasks(rows) if run.get("agent") == "checkpoint" else []:
        seeds = len(checkpoints_of(run, [row for row in rows if row.get("task") == task]))
        if seeds < wanted:
            text = f"{task} has {seeds} checkpoint(s), expected {wanted} training seeds: {conditions.name} has groups"
            found.append(text)
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
    if run.get("agent") != "checkpoint":
        return []
    found = [
        f"{task}: run.json does not say {what}, '{name}' is missing"
        for name, what in asked.items()
        for task in _tasks(rows)
        if task not in run.get(name, {})
    ]
    return found + _unknown_training(run)


def _unknown_training(run: dict[str, Any]) -> list[str]:
    """Return a problem for each checkpoint of which nothing says on which patients it was trained."""
    trained = [names if isinstance(names, list) else [names] for names in run.get("trained_on") or [None]]
    texts = [str(name) for names in trained for name in names if name is None or str(name).startswith(UNKNOWN)]
    return [f"run.json does not say on which patients the policy was trained: {text}" for text in dict.fromkeys(texts)]


def _tasks(rows: list[Row]) -> list[str]:
    return sorted({row["task"] for row in rows if "task" in row})


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
            found += [f"{population}:{_patient(member)}" for member in members.split(",")]
        else:
            stored = re.fullmatch(r"patient_(\d+)", Path(text).parent.name)  # a patient of the population in the cache
            found.append(f"population:{int(stored[1])}" if stored else "/".join(Path(text).parts[-2:]))
    return found


def _patient(member: str) -> str:
    """Return a patient of a population without its gas: ``20000`` for ``020000*0.9``, and a split as it is."""
    name = member.partition("*")[0].strip()
    return str(int(name)) if name.isdigit() else name


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
