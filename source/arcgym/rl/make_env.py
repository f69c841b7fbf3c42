# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Builds a task's environment for rsl_rl."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium as gym

from arcgym.rl.periodic_video import PeriodicVideo
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper
from arcgym.utils.progress import shown


@dataclass(frozen=True)
class VideoOptions:
    """Videos of a running environment."""

    folder: Path
    """Folder for the files."""

    length: int = 200
    """Control steps of a clip."""

    interval: int | None = None
    """Control steps between the starts of two clips; None records one clip."""


def make_env(task: str, env_cfg: Any, agent_cfg: Any, video: VideoOptions | None = None) -> RslRlVecEnvWrapper:
    """Build and reset the environment, with its stages shown and how long they took.

    Args:
        task: Registered name.
        env_cfg: Configuration of the environment.
        agent_cfg: Configuration of the agent, for its bound on actions.
        video: Videos to record, or None.
    """
    count = env_cfg.scene.num_envs
    with shown(f"{count} world{'s' * (count != 1)} on {env_cfg.sim.device}"):
        env: gym.Env = gym.make(task, cfg=env_cfg, render_mode="rgb_array" if video else None)
        if video:
            env = _recorded(env, video)
        return RslRlVecEnvWrapper(env, clip_actions=agent_cfg.clip_actions)


def _recorded(env: gym.Env, video: VideoOptions) -> PeriodicVideo:
    """Return the environment with a recorder around it."""
    from arcgym.viewers import VideoRecorder

    fps = round(1.0 / env.unwrapped.step_dt)  # type: ignore[attr-defined]
    return PeriodicVideo(
        env,
        video.folder,
        lambda path: VideoRecorder(path, fps),
        length=video.length,
        interval=video.interval or 10**9,
    )
