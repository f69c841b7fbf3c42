# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A training run from configurations to its last checkpoint."""

from __future__ import annotations

import contextlib
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rsl_rl.utils import resolve_callable

import arcgym
from arcgym.rl.device import check_launcher, is_main_process, leave_processes, place
from arcgym.rl.divergence import TrainingDiverged
from arcgym.rl.evaluation import evaluate
from arcgym.rl.interrupt import TrainingInterrupted
from arcgym.rl.make_env import VideoOptions, make_env
from arcgym.rl.preflight import check_run
from arcgym.rl.rollout_memory import describe_rollout
from arcgym.rl.run_folder import LOG_ROOT, claim_folder, create_run_folder, removed_on_failure, write_params
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper


@dataclass(frozen=True)
class TrainOptions:
    """Settings of a training run that are no part of its configurations."""

    device: str | None = None
    """``cpu``, ``cuda`` or ``cuda:<n>``; None takes the first GPU, or the CPU where there is none."""

    distributed: bool = False
    """Whether this is one process of ``torchrun``. Rank 0 alone makes folder, logs, videos and checkpoints."""

    checkpoint: Path | None = None
    """Checkpoint to go on from, or None."""

    video_interval: int | None = None
    """Control steps between the starts of two videos; None records none."""

    video_length: int = 200
    """Control steps of a video."""

    folder: Path | None = None
    """Folder of the run, which must not exist yet or be empty; None makes one below ``logs/rsl_rl``."""

    evaluates: bool = False
    """Whether each world's first episode is run with the last policy when learning has ended."""

    agent: str = "rsl_rl_cfg_entry_point"
    """Registry key of the agent; noted in the run's ``params``, where playing and evaluating find it."""


def train(task: str, env_cfg: Any, agent_cfg: Any, options: TrainOptions = TrainOptions()) -> int:
    """Check everything, build environment and runner, learn, and say where the results are.

    Returns:
        Exit status: 0; 1 after losses that are not finite; 128 and the signal's number after Ctrl-C or a kill.

    Raises:
        UsageError: Something is wrong that can be known before the run; no folder has been made.
    """
    check_launcher(options.distributed, options.device)
    output = options.folder or LOG_ROOT / agent_cfg.experiment_name
    check_run(env_cfg, agent_cfg, options.device, [output], trains=True)
    device = place(env_cfg, agent_cfg, options.device, options.distributed)
    with contextlib.ExitStack() as stack:
        if not is_main_process():
            silence = stack.enter_context(open(os.devnull, "w"))
            stack.enter_context(contextlib.redirect_stdout(silence))
        folder = _start_folder(task, env_cfg, agent_cfg, options) if is_main_process() else None
        with removed_on_failure(folder):
            env = make_env(task, env_cfg, agent_cfg, _video(options, folder))
            runner = _make_runner(env, agent_cfg, folder, device)
            if options.checkpoint is not None:
                runner.load(str(options.checkpoint))
                print(f"resumed from {options.checkpoint} at iteration {runner.current_learning_iteration}")
        return _learn(runner, env, agent_cfg, folder, device if options.evaluates else None)


def _start_folder(task: str, env_cfg: Any, agent_cfg: Any, options: TrainOptions) -> Path:
    """Return the folder of this run, with its parameters in it."""
    if options.folder is None:
        folder = create_run_folder(agent_cfg.experiment_name, agent_cfg.run_name)
    else:
        folder = claim_folder(options.folder)
    with removed_on_failure(folder):
        env_cfg.log_dir = str(folder)
        about = {"task": task, "agent": options.agent, "arcgym": arcgym.__version__, "command": sys.argv}
        about |= {"resumed_from": str(options.checkpoint)} if options.checkpoint else {}
        write_params(folder, run=about, env=env_cfg, agent=agent_cfg)
    return folder


def _video(options: TrainOptions, folder: Path | None) -> VideoOptions | None:
    """Return what to record; the main process alone records."""
    if folder is None or not options.video_interval:
        return None
    return VideoOptions(folder / "videos" / "train", options.video_length, options.video_interval)


def _make_runner(env: RslRlVecEnvWrapper, agent_cfg: Any, folder: Path | None, device: str) -> Any:
    """Build the runner that the agent's configuration names, and print what it is made of."""
    print(env.unwrapped.summary())
    print(describe_rollout(env.get_observations(), env.num_actions, agent_cfg.num_steps_per_env))
    runner_class = resolve_callable(agent_cfg.class_name)
    runner = runner_class(env, agent_cfg.to_dict(), log_dir=str(folder) if folder else None, device=device)
    if hasattr(runner, "describe_models"):
        print(runner.describe_models())
    return runner


def _learn(
    runner: Any, env: RslRlVecEnvWrapper, agent_cfg: Any, folder: Path | None, evaluation_device: str | None
) -> int:
    """Learn, evaluate where it is asked for, say where the results are, and return the exit status."""
    status = 0
    try:
        runner.learn(agent_cfg.max_iterations, agent_cfg.init_at_random_ep_len)
        leave_processes()
        if evaluation_device is not None and is_main_process():
            evaluate(runner, env, evaluation_device, folder)
    except TrainingInterrupted as interrupt:
        status = 128 + interrupt.signal_number
        if folder is not None:
            print(f"stopped by {interrupt}; go on with: --resume --load_run {folder.name}")
    except TrainingDiverged as error:
        status = 1
        print(f"training stopped in {error}.", file=sys.stderr)
    finally:
        env.close()
        print(f"run: {folder}")
    print(f"checkpoint: {getattr(runner, 'last_checkpoint', None) or 'none'}")
    return status
