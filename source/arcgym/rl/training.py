# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A training run from configurations to its last checkpoint."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rsl_rl.utils import resolve_callable

from arcgym.rl.device import place
from arcgym.rl.interrupt import TrainingInterrupted
from arcgym.rl.make_env import VideoOptions, make_env
from arcgym.rl.rollout_memory import describe_rollout
from arcgym.rl.run_folder import create_run_folder, find_checkpoint, write_params
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper


@dataclass(frozen=True)
class TrainOptions:
    """Settings of a training run that are no part of its configurations."""

    device: str | None = None
    """``cpu``, ``cuda`` or ``cuda:<n>``; None takes the first GPU, or the CPU where there is none."""

    distributed: bool = False
    """Whether this is one process of ``torchrun``."""

    video_interval: int | None = None
    """Control steps between the starts of two videos; None records none."""

    video_length: int = 200
    """Control steps of a video."""


def train(task: str, env_cfg: Any, agent_cfg: Any, options: TrainOptions = TrainOptions()) -> int:
    """Build environment and runner, learn, and say where the results are.

    Returns:
        Exit status: 0, or 128 and the signal's number after Ctrl-C or a kill.
    """
    checkpoint = None
    if agent_cfg.resume:
        checkpoint = find_checkpoint(agent_cfg.experiment_name, agent_cfg.load_run, agent_cfg.load_checkpoint)
    device = place(env_cfg, agent_cfg, options.device, options.distributed)
    folder = create_run_folder(agent_cfg.experiment_name, agent_cfg.run_name)
    env_cfg.log_dir = str(folder)
    write_params(folder, env=env_cfg, agent=agent_cfg)
    video = None
    if options.video_interval:
        video = VideoOptions(folder / "videos" / "train", options.video_length, options.video_interval)
    env = make_env(task, env_cfg, agent_cfg, video)
    runner = make_runner(env, agent_cfg, folder, device)
    if checkpoint is not None:
        runner.load(str(checkpoint))
        print(f"resumed from {checkpoint} at iteration {runner.current_learning_iteration}")
    try:
        runner.learn(agent_cfg.max_iterations, agent_cfg.init_at_random_ep_len)
    except TrainingInterrupted as interrupt:
        print(f"stopped by {interrupt}; go on with: --resume --load_run {folder.name}")
        return 128 + interrupt.signal_number
    finally:
        env.close()
        print(f"run: {folder}")
    print(f"checkpoint: {folder / f'model_{runner.current_learning_iteration}.pt'}")
    return 0


def make_runner(env: RslRlVecEnvWrapper, agent_cfg: Any, folder: Path, device: str) -> Any:
    """Say how much memory the rollout takes and build the runner that the agent's configuration names."""
    print(describe_rollout(env.get_observations(), env.num_actions, agent_cfg.num_steps_per_env))
    runner_class = resolve_callable(agent_cfg.class_name)
    return runner_class(env, agent_cfg.to_dict(), log_dir=str(folder), device=device)
