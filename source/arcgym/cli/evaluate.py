# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluate an agent on the trials of a suite.

    arcgym evaluate --agent logs/rsl_rl/arc_sigmoid_magnetic/<run>/model_100.pt --suite paper --out results/mine
    arcgym evaluate --agent random --robot Magnetic --suite paper --tasks ARC-Rectum-Magnetic --out results/random

Every trial of the suite's condition file is run once. All that is random in it follows from its seed: its result is the
same whatever the number of worlds. Rows go to trials.csv in the folder as trials end; called again, the rest is run.
Several checkpoints, separated by commas, are training seeds: trials of group g get checkpoint g. {task} in a path
stands for the task's name: --agent "runs/{task}/1.pt,runs/{task}/2.pt" --robot Magnetic.

Physics of worlds on a CPU takes one core: --processes shares the trials out. Machines share them by --share 1/2 and
--share 2/2, and arcgym results merge puts their folders together.
"""

from __future__ import annotations

import argparse
import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.cli.arguments import add_fields, argument, positive, read_fields
from arcgym.cli.stopping import stopped_cleanly
from arcgym.evaluation.result_folder import ResultFolder
from arcgym.evaluation.sharing import Share, share
from arcgym.evaluation.trials import Conditions
from arcgym.utils.untrained import UNTRAINED

TAKES_OVERRIDES = True

PREFIX = "ARC-"
"""How the names of tasks in suites begin; they end with the robot."""

USUAL_SUITE = "paper"
"""Suite where none is named. With a condition file alone the record has its name instead: the trials are no suite's."""

TRIALS_OWN = ("events", "terminations", "clinical", "scene.colon.material")
"""Parts of an environment that belong to a trial and not to an agent."""


@dataclass(frozen=True, kw_only=True)
class EvaluateArguments:
    """Arguments of ``arcgym evaluate``."""

    agent: str = argument("checkpoint, or several separated by commas, or zero, random, expert")
    out: str = argument("folder of the results")
    suite: str | None = argument("suite of tasks (default: paper)", None)
    tasks: str | None = argument("tasks of the suite, separated by commas (default: all of the robot)", None)
    robot: str | None = argument("robot (default: the one that the checkpoint was trained with)", None)
    conditions: str | None = argument("condition file (default: the suite's)", None)
    videos: bool = argument("film the best, median and worst trial of each task", False)
    num_envs: int | None = argument("largest number of worlds (default: 256, on a CPU 6)", None, type=positive)
    num_patients: int | None = argument("largest number of patients (default: 256, on a CPU 64)", None, type=positive)
    processes: int = argument("processes that share the trials, such as cores of a CPU (default: 1)", 1, type=positive)
    share: Share = argument("run only this share of the trials, k/n (default: 1/1)", Share(), type=share)
    device: str | None = argument("cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)", None)
    overrides: list[str] = dataclasses.field(default_factory=list)
    """Texts ``env.path=value``."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_fields(parser, EvaluateArguments)


def run(namespace: argparse.Namespace) -> None:
    """Run the trials, print the summary and write it."""
    from arcgym.evaluation.set_by_trials import refuse_what_trials_set
    from arcgym.evaluation.suites import read_suites, refuse_earlier, split_task
    from arcgym.evaluation.trials import read_conditions

    args = read_fields(EvaluateArguments, namespace)
    refuse_what_trials_set(args.overrides)
    suite = _choose(args.suite or USUAL_SUITE, read_suites(), "suite")
    agents = tuple(args.agent.split(","))
    tasks = args.tasks.split(",") if args.tasks else suite.tasks(args.robot or _robot_of(agents[0]))
    _check_tasks(tasks)
    _note_other_tasks(tasks, suite, args)
    conditions = read_conditions(Path(args.conditions) if args.conditions else suite.conditions_path)
    refuse_earlier(conditions)

    from arcgym.evaluation.evaluate import evaluate
    from arcgym.evaluation.options import EvaluationOptions

    overrides = (*suite.overrides, *args.overrides)
    name = args.suite or (conditions.name if args.conditions else USUAL_SUITE)
    options = EvaluationOptions(agents, name, overrides, args.num_envs, args.num_patients, args.device, args.share)

    def load(task: str, checkpoint: Path | None) -> tuple[Any, Any]:
        return load_trial_cfgs(split_task(task)[0], checkpoint, (*suite.overrides_of(task), *args.overrides))

    with stopped_cleanly(f"{args.out} has the trials that ended, and the same command goes on"):
        if min(args.processes, len(conditions.trials)) > 1:
            folder = _evaluate_in_processes(args, conditions, len(tasks))
        else:
            folder = evaluate(tasks, conditions, load, options, Path(args.out))
    _write_reports(folder)
    if args.videos:
        from arcgym.evaluation.videos import film

        for path in film(conditions, load, options, folder):
            print(f"video: {path}")


def _evaluate_in_processes(args: EvaluateArguments, conditions: Conditions, num_tasks: int) -> ResultFolder:
    """Run the evaluation in several processes and return the folder of all rows.

    Raises:
        UsageError: It is a share itself.
    """
    from arcgym.evaluation.sharing import run_shares
    from arcgym.utils.errors import UsageError

    if args.share.of > 1:
        raise UsageError(f"--processes and --share {args.share} cannot be given together: shares have one process.")
    names = ("agent", "suite", "tasks", "robot", "conditions", "num_envs", "num_patients", "device")
    given = [(name, getattr(args, name)) for name in names if getattr(args, name) is not None]
    words = [word for name, value in given for word in (f"--{name}", str(value))]
    processes = min(args.processes, len(conditions.trials))
    return run_shares([*words, *args.overrides], processes, conditions.trials, num_tasks, Path(args.out))


def _write_reports(folder: ResultFolder) -> None:
    """Write summary and Parquet of a folder, and print the summary and where they are."""
    from arcgym.evaluation.parquet import write_parquet
    from arcgym.evaluation.result_folder import SUMMARY_FILE
    from arcgym.evaluation.summary import report

    table = report(folder.rows)
    (folder.path / SUMMARY_FILE).write_text(table)
    print(table)
    print(f"rows: {folder.path / 'trials.csv'}")
    parquet = write_parquet(folder.path)
    print(f"rows as Parquet: {parquet or 'none, it needs pyarrow (pip install arcgym[study])'}")


def _choose(name: str, known: Mapping[str, Any], kind: str) -> Any:
    from arcgym.utils.errors import UsageError
    from arcgym.utils.string import did_you_mean

    if name not in known:
        raise UsageError(f"No {kind} '{name}'. {did_you_mean(name, known)}")
    return known[name]


def _robot_of(agent: str) -> str:
    """Return the robot that a checkpoint was trained with."""
    from arcgym.rl.params import read_params
    from arcgym.utils.errors import UsageError
    from arcgym.utils.registry import plain_task

    if agent in UNTRAINED:
        raise UsageError(f"--agent {agent} needs --robot, such as Magnetic, or --tasks.")
    params = read_params(_checkpoint(agent).parent)
    if params is None:
        raise UsageError(f"{agent} has no params/ beside it, which names its task: give --robot or --tasks.")
    task = plain_task(params.task)
    if not task.startswith(PREFIX):
        raise UsageError(f"{agent} was trained in {task}, which no suite has: give --tasks {task}, or --robot.")
    return task.split("-")[-1]


def _checkpoint(agent: str) -> Path:
    from arcgym.utils.errors import UsageError

    path = Path(agent)
    if not path.is_file():
        raise UsageError(f"No checkpoint {agent}; expected a file, or one of {', '.join(UNTRAINED)}.")
    return path


def _check_tasks(tasks: list[str]) -> None:
    """Raise if a task is not registered."""
    from arcgym.evaluation.suites import split_task
    from arcgym.utils.registry import list_tasks

    known = {name: None for name in list_tasks(prefix="")}
    for task in tasks:
        _choose(split_task(task)[0], known, "task")


def _note_other_tasks(tasks: list[str], suite: Any, args: EvaluateArguments) -> None:
    """Say which tasks are not the suite's: they run on its trials, and cannot be published as its results."""
    others = [task for task in tasks if task not in suite.tasks(task.partition(":")[0].rpartition("-")[2])]
    if others and not args.conditions:
        print(
            f"note: {', '.join(others)} is no task of the suite {args.suite or USUAL_SUITE}: results check refuses it"
        )


def load_trial_cfgs(task: str, checkpoint: Path | None, overrides: tuple[str, ...]) -> tuple[Any, Any]:
    """Return the configurations of a task, as the checkpoint was trained with them, with the overrides on top.

    Events, terminations and tissue stay the task's, or the suite's: they make the trials, the same for all agents,
    whatever a training had.
    """
    from arcgym.cli.arguments import RunArguments, TaskArguments
    from arcgym.cli.task import load_cfgs, load_run_cfgs

    if checkpoint is None:
        return load_cfgs(TaskArguments(task=task, overrides=list(overrides)))
    env_cfg, agent_cfg, _ = load_run_cfgs(
        RunArguments(task=task, checkpoint=str(_checkpoint(str(checkpoint)).resolve()), overrides=list(overrides)),
        as_registered=TRIALS_OWN,
    )
    return env_cfg, agent_cfg
