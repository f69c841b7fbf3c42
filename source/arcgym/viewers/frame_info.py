# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Numbers that a video frame shows about its environment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from arcgym.anatomy.segments import SEGMENTS
from arcgym.viewers.palette import VISIBLE_FORCE

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


@dataclass(frozen=True)
class FrameInfo:
    """State of one world, as numbers of the host."""

    time: float = 0.0
    """Since the start of the episode [s]."""
    segment: str = ""
    """Segment that the tip is in."""
    tip_arc: float = 0.0
    """Arc length of the tip from the anal verge [m]."""
    inserted: float = 0.0
    """Length of scope inside the anus [m]."""
    tip_force: float = 0.0
    """Wall force on the tip [N]."""
    max_force: float = 0.0
    """Largest wall force on a window of the scope [N]."""
    max_force_arc: float | None = None
    """Distance of that window's middle from the front of the tip, along the scope [m]; None where nothing presses."""
    looping: float | None = None
    """Length of scope inside over the way to the tip; None if the task does not measure it."""
    reward: float | None = None
    """Reward of the last step; None if the environment has none."""
    task_range: tuple[float, float] | None = None
    """Arc length at start and goal of the task [m]; None if there is no task."""
    terms: dict[str, float] = field(default_factory=dict)
    """Further numbers to show, by label."""


def read_info(
    env: ManagerBasedEnv, env_id: int, extra: Mapping[str, Any] | None = None, metrics: Sequence[str] = ()
) -> FrameInfo:
    """Return the state of one world; what the environment lacks stays at its default.

    Args:
        env: The environment; its scene holds ``colon`` and ``endoscope``.
        env_id: World to read.
        extra: Numbers to show beside it. ``reward`` replaces the environment's.
        metrics: Metrics terms to show.
    """
    data = env.scene["endoscope"].data
    terms = {**_metrics(env, env_id, metrics), **{name: float(value) for name, value in (extra or {}).items()}}
    reward = terms.pop("reward", None)
    if reward is None and hasattr(env, "reward_buf"):
        reward = float(env.reward_buf[env_id])
    steps = getattr(env, "episode_length_buf", None)
    window = data.window_force_norm[env_id]
    max_force = float(window.max())
    return FrameInfo(
        time=0.0 if steps is None else float(steps[env_id]) * env.step_dt,
        segment=SEGMENTS[int(data.tip_segment[env_id])],
        tip_arc=float(data.tip_arc_length[env_id]),
        inserted=float(data.inserted_length[env_id]),
        tip_force=float(data.tip_force[env_id]),
        max_force=max_force,
        max_force_arc=float(data.window_arc[int(window.argmax())]) if max_force > VISIBLE_FORCE else None,
        looping=_metrics(env, env_id, ("looping_ratio",)).get("looping_ratio"),
        reward=reward,
        task_range=_task_range(env, env_id),
        terms=terms,
    )


def _metrics(env: ManagerBasedEnv, env_id: int, names: Sequence[str]) -> dict[str, float]:
    """Return the values of some metrics terms in the last step, as far as the task has them."""
    manager = getattr(env, "metrics_manager", None)
    values = {} if manager is None else manager.step_values
    return {name: float(values[name][env_id]) for name in names if name in values}


def _task_range(env: ManagerBasedEnv, env_id: int) -> tuple[float, float] | None:
    segment = getattr(env.cfg, "segment", None)
    return env.scene["colon"].patient_of(env_id).bounds.get(segment)
