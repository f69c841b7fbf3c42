# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluation of agents on the trials of a suite: rows, summary, identity of what was run."""

from __future__ import annotations

import io
import json
import platform
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from arcgym.envs.provenance import versions
from arcgym.evaluation.agents import inputs_of, trained_agent
from arcgym.evaluation.result_folder import ResultFolder, alone_in
from arcgym.evaluation.run_trials import run_trials
from arcgym.evaluation.sharing import Share, gather
from arcgym.evaluation.suites import split_task
from arcgym.evaluation.trial_queue import give_patient_of_trial
from arcgym.evaluation.trials import Conditions, Trial
from arcgym.managers import EventTermCfg
from arcgym.rl.checkpoint import file_sha256, read_checkpoint
from arcgym.rl.device import choose_device, place
from arcgym.rl.make_env import make_env
from arcgym.rl.params import differences, read_params
from arcgym.rl.preflight import check_values
from arcgym.rl.pretrained import ABOUT
from arcgym.rl.rollout import UNTRAINED, Policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper
from arcgym.utils.coerce import to_plain
from arcgym.utils.errors import UsageError
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

WORLDS = {"cuda": 256, "cpu": 6}
"""Worlds at a time where no number is given, by kind of device. On a GPU a step of 256 worlds takes little longer than
one of 30. On a CPU its time grows with their number, those included for which no trial is left while the last end."""

PATIENTS = {"cuda": 256, "cpu": 64}
"""Patients at a time where no number is given, by kind of device."""

LoadCfgs = Callable[[str, Path | None], tuple[Any, Any]]
"""From task and checkpoint to the configurations of environment and agent."""


@dataclass(frozen=True)
class EvaluationOptions:
    """Settings of :func:`evaluate` beside tasks and trials."""

    agents: tuple[str, ...]
    """A name in :data:`arcgym.rl.rollout.UNTRAINED`, or checkpoints. Trials of group g get checkpoint g, or the
    only one. ``{task}`` in a path stands for the registered name of the task: each has policies of its own."""

    def agents_for(self, task: str) -> tuple[str, ...]:
        """Return the agents of a task."""
        return tuple(agent.replace("{task}", split_task(task)[0]) for agent in self.agents)

    suite: str
    """Name of the suite, for the record."""

    overrides: tuple[str, ...] = ()
    """Overrides of the configurations, for the record."""

    num_envs: int | None = None
    """Largest number of worlds at a time; None takes that of :data:`WORLDS`. Results do not depend on it."""

    num_patients: int | None = None
    """Largest number of patients in the memory of the device at a time; None takes that of :data:`PATIENTS`."""

    device: str | None = None
    """``cpu``, ``cuda`` or ``cuda:<n>``; None takes the first GPU, or the CPU where there is none."""

    share: Share = Share()
    """Trials that are run."""

    def most(self, given: int | None, usual: dict[str, int]) -> int:
        """Return a largest number of worlds or patients: the given one, or that of the kind of device."""
        return given or usual[choose_device(self.device).partition(":")[0]]


def evaluate(
    tasks: Sequence[str], conditions: Conditions, load_cfgs: LoadCfgs, options: EvaluationOptions, out: Path
) -> ResultFolder:
    """Run every trial of every task that has no row yet, and return the folder with all rows.

    Args:
        tasks: Registered names, each with ``:variant`` behind it or without.
        conditions: Trials of each task.
        load_cfgs: Gives the configurations of a task as the agent was trained with them.
        options: Agents and settings.
        out: Folder of the results.

    Raises:
        UsageError: The folder holds another evaluation, or is written to by one, or a setting of a task is wrong.
    """
    run = run_record(tasks, conditions, options)
    _check_all(tasks, load_cfgs, options)
    with alone_in(out):
        gather(out)
        folder = ResultFolder(out, run)
        for task in tasks:
            done = folder.done(task)
            trials = options.share.trials(conditions.trials)
            left = [trial for trial in trials if trial.trial not in done]
            print(f"{task}: {len(left)} of {len(trials)} trials to run", flush=True)
            for agent, batch in _batches(left, options.agents_for(task), options.most(options.num_patients, PATIENTS)):
                _run_batch(task, agent, batch, load_cfgs, options, folder)
    return folder


def _check_all(tasks: Sequence[str], load_cfgs: LoadCfgs, options: EvaluationOptions) -> None:
    """Check the settings of all tasks, of which the last may begin hours after the first."""
    for task in tasks:
        for agent in options.agents_for(task):
            with redirect_stdout(io.StringIO()):  # what is said of them is said when they run
                cfgs = load_cfgs(task, checkpoint_of(agent))
            check_values(*cfgs)


def run_record(tasks: Sequence[str], conditions: Conditions, options: EvaluationOptions) -> dict[str, Any]:
    """Return what identifies an evaluation, and the versions and the machine it is made with.

    Checkpoints are listed in the order of the tasks that have some of their own, then of the groups.

    Raises:
        UsageError: A checkpoint is missing or would run no trial, or of several agents one is no checkpoint.
    """
    untrained = [agent for agent in options.agents if agent in UNTRAINED]
    if untrained and len(options.agents) > 1:
        raise UsageError(
            f"--agent is {','.join(options.agents)}; expected checkpoints, which are training seeds, or {untrained[0]} "
            "alone: other agents are evaluations of their own."
        )
    if len(options.agents) > conditions.groups:
        raise UsageError(
            f"--agent has {len(options.agents)} checkpoints, and trials of {conditions.name} have {conditions.groups} "
            "group(s), one for each training seed: the others would run nothing. Evaluate each in a folder of its own, "
            "or take a suite with more groups, such as paper or population."
        )
    agents = dict.fromkeys(agent for task in tasks for agent in options.agents_for(task))
    checkpoints = [] if options.agents[0] in UNTRAINED else [Path(agent) for agent in agents]
    missing = [str(path) for path in checkpoints if not path.is_file()]
    if missing:
        raise UsageError(f"No checkpoint {', '.join(missing)}; expected files, or one of {', '.join(UNTRAINED)}.")
    return {
        "agent": ",".join(options.agents) if not checkpoints else "checkpoint",
        "checkpoint": [str(path) for path in checkpoints],
        "checkpoint_sha256": [file_sha256(path) for path in checkpoints],
        "trained_on": [trained_on(path) for path in checkpoints],
        "training": [training_of(path) for path in checkpoints],
        "suite": options.suite,
        "conditions": conditions.name,
        "conditions_sha256": conditions.sha256,
        "overrides": list(options.overrides),
        "versions": versions(),
        "machine": f"{platform.processor() or platform.machine()}, {_accelerator(options.device)}",
    }


def trained_on(checkpoint: Path) -> Any:
    """Return the patients that a checkpoint was trained on; None where nothing beside it says so.

    The parameters of its run name them; those of a shipped policy do not, but its description does.
    """
    about = checkpoint.with_name(ABOUT)
    if about.is_file():
        return json.loads(about.read_text()).get("trained_on")
    saved = read_params(checkpoint.parent)
    return None if saved is None else saved.env["scene"]["colon"].get("usd_path")


def training_of(checkpoint: Path) -> dict[str, Any]:
    """Return agent, task, limits, transitions and seconds that a checkpoint was trained with, as far as it says so."""
    saved, infos = read_params(checkpoint.parent), read_checkpoint(checkpoint)["infos"] or {}
    found = {name: infos[name] for name in ("transitions", "seconds") if name in infos}
    if saved is None:
        return found
    limits = saved.agent.get("algorithm", {}).get("limits")
    return {"agent": saved.agent_key, "task": saved.task, **found} | ({"limits": limits} if limits else {})


def changes_of(task: str, env_cfg: Any) -> dict[str, list[Any]]:
    """Return registered and used value of every field of the environment, by path, where they differ.

    A policy runs with the settings that it was trained with: what was made easier in training is easier here, too.
    Fields of an effect that is off in both change nothing and are left out: a policy is not another task's because
    the default of such a field has changed since it was trained.
    """
    registered = load_cfg_from_registry(split_task(task)[0], "env_cfg_entry_point")
    found = differences(to_plain(registered), to_plain(env_cfg))
    return {
        path: list(values)
        for path, values in found.items()
        if path not in SET_HERE and not (_is_off(path, registered) and _is_off(path, env_cfg))
    }


def _is_off(path: str, cfg: Any) -> bool:
    """Return whether a field, by its dotted path, is one of an effect that is switched off."""
    for name in path.split(".")[:-1]:
        cfg = cfg.get(name) if isinstance(cfg, dict) else getattr(cfg, name, None)
        if getattr(cfg, "active", True) is False:
            return True
    return False


def _batches(trials: Sequence[Trial], agents: Sequence[str], most: int) -> list[tuple[str, list[Trial]]]:
    """Return the trials that can share an environment: of one agent, and of so many patients at most."""
    chosen = {agent: [trial for trial in trials if agent_of(trial, agents) == agent] for agent in agents}
    batches = []
    for agent, members in chosen.items():
        of_patient: dict[str, list[Trial]] = {}
        for trial in members:
            of_patient.setdefault(trial.patient, []).append(trial)
        groups = list(of_patient.values())
        parts = [groups[first : first + most] for first in range(0, len(groups), most)]
        batches += [(agent, [trial for group in part for trial in group]) for part in parts]
    return batches


def _run_batch(
    task: str,
    agent: str,
    trials: list[Trial],
    load_cfgs: LoadCfgs,
    options: EvaluationOptions,
    folder: ResultFolder,
) -> None:
    """Run trials with one agent in an environment that holds all their patients."""
    patients = patients_of(trials)
    cfgs = load_cfgs(task, checkpoint_of(agent))
    folder.note_changes(task, changes_of(task, cfgs[0]))
    if agent not in UNTRAINED:
        folder.note_inputs(task, inputs_of(*cfgs))
    with opened(task, agent, trials, cfgs, options) as (env, make_policy):
        with counted(task if len(patients) > 1 else f"{task}, {patients[0]}", len(trials)) as show:
            started = len(folder.rows)

            def keep(row: dict[str, Any]) -> None:
                folder.add({"task": task, "agent": folder.names.get(agent, agent), **row})
                show(len(folder.rows) - started)

            run_trials(env, make_policy, trials, keep, patients)


@contextmanager
def opened(
    task: str, agent: str, trials: Sequence[Trial], cfgs: tuple[Any, Any], options: EvaluationOptions
) -> Iterator[tuple[RslRlVecEnvWrapper, Callable[[RslRlVecEnvWrapper], Policy]]]:
    """Open an environment for trials, and give it with what makes the agent's policy.

    Args:
        task: Name of the task, with its variant.
        agent: One of ``options.agents``.
        trials: Trials that it shall run.
        cfgs: Configurations of environment and agent; the environment's is changed.
        options: As for :func:`evaluate`.
    """
    env_cfg, agent_cfg = cfgs
    _hold_patients(env_cfg, patients_of(trials))
    env_cfg.scene.num_envs = min(options.most(options.num_envs, WORLDS), len(trials))
    env_cfg.recorders = None
    place(env_cfg, agent_cfg, options.device)
    env = make_env(split_task(task)[0], env_cfg, agent_cfg)
    try:
        yield env, UNTRAINED.get(agent) or (lambda env: trained_agent(env, agent_cfg, Path(agent)))
    finally:
        env.close()


def patients_of(trials: Sequence[Trial]) -> list[str]:
    """Return the patients of trials, each once, in order."""
    return list(dict.fromkeys(trial.patient for trial in trials))


def agent_of(trial: Trial, agents: Sequence[str]) -> str:
    """Return the agent that runs a trial: that of its group."""
    return agents[trial.group % len(agents)]


def checkpoint_of(agent: str) -> Path | None:
    """Return the checkpoint that an agent is, None for one without."""
    return None if agent in UNTRAINED else Path(agent)


def _hold_patients(env_cfg: Any, patients: list[str]) -> None:
    """Put patients into an environment, each world of which takes that of its trial.

    Raises:
        UsageError: There are several, and the task has no event that comes before its reset.
    """
    several = len(patients) > 1
    env_cfg.scene.colon.usd_path, env_cfg.scene.colon.num_patients = patients if several else patients[0], None
    if several:
        if next((name for name, term in vars(env_cfg.events).items() if term is not None), None) != "patient":
            raise UsageError(
                "The task's events do not begin with 'patient', so that worlds cannot change their patients: put "
                "patient = EventTermCfg(func=mdp.randomize_patient, mode='reset') first, or give --num_patients 1."
            )
        env_cfg.events.patient = EventTermCfg(func=give_patient_of_trial, mode="reset")


def _accelerator(device: str | None) -> str:
    """Return the GPU that runs the trials: none where they run on the CPU of a machine that has one."""
    chosen = choose_device(device)
    return torch.cuda.get_device_name(chosen) if chosen.startswith("cuda") else "no GPU"
