# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluation of agents on the trials of a suite: rows, summary, identity of what was run."""

from __future__ import annotations

import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import torch

from arcgym.envs.provenance import versions
from arcgym.evaluation.agents import file_sha256, trained_agent
from arcgym.evaluation.result_folder import ResultFolder
from arcgym.evaluation.run_trials import run_trials
from arcgym.evaluation.trials import Conditions, Trial
from arcgym.rl.device import place
from arcgym.rl.make_env import make_env
from arcgym.rl.params import differences
from arcgym.rl.rollout import UNTRAINED
from arcgym.utils.coerce import to_plain
from arcgym.utils.progress import counted
from arcgym.utils.registry import load_cfg_from_registry

SET_HERE = (
    "seed",
    "log_dir",
    "recorders",
    "sim.device",
    "scene.num_envs",
    "scene.colon.usd_path",
    "scene.colon.num_patients",
)
"""Fields that an evaluation sets itself."""

LoadCfgs = Callable[[str, Path | None], tuple[Any, Any]]
"""From task and checkpoint to the configurations of environment and agent."""


@dataclass(frozen=True)
class EvaluationOptions:
    """Settings of :func:`evaluate` beside tasks and trials."""

    agents: tuple[str, ...]
    """A name in :data:`arcgym.rl.rollout.UNTRAINED`, or checkpoints. Trials of group g get checkpoint g, or the
    only one."""

    suite: str
    """Name of the suite, for the record."""

    overrides: tuple[str, ...] = ()
    """Overrides of the configurations, for the record."""

    num_envs: int = 30
    """Largest number of worlds at a time. Results do not depend on it."""

    device: str | None = None
    """``cpu``, ``cuda`` or ``cuda:<n>``; None takes the first GPU, or the CPU where there is none."""


def evaluate(
    tasks: Sequence[str], conditions: Conditions, load_cfgs: LoadCfgs, options: EvaluationOptions, out: Path
) -> ResultFolder:
    """Run every trial of every task that has no row yet, and return the folder with all rows.

    Args:
        tasks: Registered names.
        conditions: Trials of each task.
        load_cfgs: Gives the configurations of a task as the agent was trained with them.
        options: Agents and settings.
        out: Folder of the results.

    Raises:
        UsageError: The folder holds another evaluation.
    """
    folder = ResultFolder(out, run_record(conditions, options))
    for task in tasks:
        done = folder.done(task)
        left = [trial for trial in conditions.trials if trial.trial not in done]
        print(f"{task}: {len(left)} of {len(conditions.trials)} trials to run", flush=True)
        for (agent, patient), trials in _batches(left, options.agents):
            _run_batch(task, agent, patient, trials, load_cfgs, options, folder)
    return folder


def run_record(conditions: Conditions, options: EvaluationOptions) -> dict[str, Any]:
    """Return what identifies an evaluation, and the versions and the machine it is made with."""
    checkpoints = [] if options.agents[0] in UNTRAINED else [Path(agent) for agent in options.agents]
    return {
        "agent": ",".join(options.agents) if not checkpoints else "checkpoint",
        "checkpoint": [str(path) for path in checkpoints],
        "checkpoint_sha256": [file_sha256(path) for path in checkpoints],
        "suite": options.suite,
        "conditions": conditions.name,
        "conditions_sha256": conditions.sha256,
        "overrides": list(options.overrides),
        "versions": versions(),
        "machine": f"{platform.processor() or platform.machine()}, {_accelerator()}",
    }


def changes_of(task: str, env_cfg: Any) -> dict[str, list[Any]]:
    """Return registered and used value of every field of the environment, by path, where they differ.

    A policy runs with the settings that it was trained with: what was made easier in training is easier here, too.
    """
    registered = to_plain(load_cfg_from_registry(task, "env_cfg_entry_point"))
    found = differences(registered, to_plain(env_cfg))
    return {path: list(values) for path, values in found.items() if path not in SET_HERE}


def _batches(trials: Sequence[Trial], agents: Sequence[str]) -> list[tuple[tuple[str, str], list[Trial]]]:
    """Return the trials that can share an environment, by agent and patient."""

    def key(trial: Trial) -> tuple[str, str]:
        return agents[trial.group % len(agents)], trial.patient

    return [(pair, list(members)) for pair, members in groupby(sorted(trials, key=key), key)]


def _run_batch(
    task: str,
    agent: str,
    patient: str,
    trials: list[Trial],
    load_cfgs: LoadCfgs,
    options: EvaluationOptions,
    folder: ResultFolder,
) -> None:
    """Run the trials of one patient with one agent in an environment of their own."""
    checkpoint = None if agent in UNTRAINED else Path(agent)
    env_cfg, agent_cfg = load_cfgs(task, checkpoint)
    folder.note_changes(task, changes_of(task, env_cfg))
    env_cfg.scene.num_envs = min(options.num_envs, len(trials))
    env_cfg.scene.colon.usd_path, env_cfg.scene.colon.num_patients = patient, None
    env_cfg.seed, env_cfg.recorders = 0, None
    place(env_cfg, agent_cfg, options.device)
    env = make_env(task, env_cfg, agent_cfg)
    try:
        with counted(f"{task}, {patient}", len(trials)) as show:
            started = len(folder.rows)

            def keep(row: dict[str, Any]) -> None:
                folder.add({"task": task, "agent": agent, **row})
                show(len(folder.rows) - started)

            make_policy = UNTRAINED.get(agent) or (lambda env: trained_agent(env, agent_cfg, Path(agent)))
            run_trials(env, make_policy, trials, keep)
    finally:
        env.close()


def _accelerator() -> str:
    return torch.cuda.get_device_name() if torch.cuda.is_available() else "no GPU"
