# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluation of agents on the trials of a suite, a batch of trials that share an environment after the other."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import Any

from arcgym.evaluation.agents import inputs_of, trained_agent
from arcgym.evaluation.identity import changes_of, run_record
from arcgym.evaluation.options import PATIENTS, WORLDS, EvaluationOptions, LoadCfgs
from arcgym.evaluation.result_folder import ResultFolder, alone_in
from arcgym.evaluation.run_trials import run_trials
from arcgym.evaluation.sharing import gather
from arcgym.evaluation.suites import split_task
from arcgym.evaluation.task_settings import SETTINGS
from arcgym.evaluation.trial_queue import give_patient_of_trial
from arcgym.evaluation.trials import Conditions, Trial
from arcgym.managers import EventTermCfg
from arcgym.rl.device import place
from arcgym.rl.make_env import make_env
from arcgym.rl.preflight import check_values
from arcgym.rl.rollout import UNTRAINED_POLICIES, Policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper
from arcgym.utils.errors import UsageError
from arcgym.utils.progress import counted


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
        try:
            for task in tasks:
                _run_task(task, conditions, load_cfgs, options, folder)
        finally:
            if not folder.rows:  # a start that fails leaves nothing that the next one has to fit
                folder.clear()
    return folder


def _run_task(
    task: str, conditions: Conditions, load_cfgs: LoadCfgs, options: EvaluationOptions, folder: ResultFolder
) -> None:
    """Run the trials of a task that have no row yet."""
    done = folder.done(task)
    trials = options.share.trials(conditions.trials)
    left = [trial for trial in trials if trial.trial not in done]
    print(f"{task}: {len(left)} of {len(trials)} trials to run", flush=True)
    agents = options.agents_for(task)
    of_agent = {trial.trial: agents[conditions.checkpoint_number(trial, len(agents))] for trial in trials}
    if len(unused := set(agents) - set(of_agent.values())) > 0:
        print(f"note: this share has no trial of {', '.join(sorted(unused))}: its figures are of the others alone")
    for agent, batch in _batches(left, of_agent, options.most(options.num_patients, PATIENTS)):
        _run_batch(task, agent, batch, load_cfgs, options, folder)


def _check_all(tasks: Sequence[str], load_cfgs: LoadCfgs, options: EvaluationOptions) -> None:
    """Check the settings of all tasks, of which the last may begin hours after the first."""
    for task in tasks:
        for agent in options.agents_for(task):
            with redirect_stdout(io.StringIO()):  # what is said of them is said when they run
                cfgs = load_cfgs(task, checkpoint_of(agent))
            check_values(*cfgs)


def _batches(trials: Sequence[Trial], of_agent: dict[int, str], most: int) -> list[tuple[str, list[Trial]]]:
    """Return the trials that can share an environment: of one agent, and of so many patients at most."""
    chosen: dict[str, list[Trial]] = {}
    for trial in trials:
        chosen.setdefault(of_agent[trial.trial], []).append(trial)
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
    for setting in SETTINGS:
        folder.note_setting(setting, task, setting.of(cfgs[0]))
    if agent not in UNTRAINED_POLICIES:
        folder.note_inputs(task, inputs_of(*cfgs))
    with opened(task, agent, trials, cfgs, options) as (env, make_policy):
        with counted(task if len(patients) > 1 else f"{task}, {patients[0]}", len(trials)) as show:
            started = len(folder.rows)

            def keep(row: dict[str, Any]) -> None:
                folder.add({"task": task, "agent": folder.names.get(agent, agent), **row})
                show(len(folder.rows) - started)

            before = folder.dropped(task)
            try:
                run_trials(env, make_policy, trials, keep, patients)
            finally:  # also of an evaluation that is stopped: its rows stay
                folder.note_dropped(task, before + int(env.unwrapped.sim.dropped_contacts.sum()))


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
    env_cfg.recorders = env_cfg.curriculum = None
    place(env_cfg, agent_cfg, options.device)
    env = make_env(split_task(task)[0], env_cfg, agent_cfg)
    try:
        yield env, UNTRAINED_POLICIES.get(agent) or (lambda env: trained_agent(env, agent_cfg, Path(agent)))
    finally:
        env.close()


def patients_of(trials: Sequence[Trial]) -> list[str]:
    """Return the patients of trials, each once, in order."""
    return list(dict.fromkeys(trial.patient for trial in trials))


def checkpoint_of(agent: str) -> Path | None:
    """Return the checkpoint that an agent is, None for one without."""
    return None if agent in UNTRAINED_POLICIES else Path(agent)


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
