# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Termination terms ``(env, **params) -> (N,) bool``.

Limits of force, strain and pull are in :mod:`arcgym.envs.mdp.loads`, success in :mod:`arcgym.envs.mdp.segments`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.lumen import LUMEN_PRESETS, LumenCfg, lumen_scores
from arcgym.envs.mdp.observations import tip_lumen_direction
from arcgym.managers import ManagerTermBase, TerminationTermCfg, reads_no_sensor
from arcgym.utils.validation import FINITE, POSITIVE, Range, expects
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

__all__ = ["episode_cost_above", "facing", "lumen_not_visible", "scope_out", "stuck", "time_out", "wall_penetrated"]


@reads_no_sensor
def time_out(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Whether the episode has lasted ``env.max_episode_length`` steps, bool, shape (N,).

    A truncation: set ``time_out=True`` in its config.
    """
    return env.episode_length_buf >= env.max_episode_length


@reads_no_sensor
@expects(arc_length=FINITE)
def scope_out(env: ManagerBasedRLEnv, arc_length: float = 0.0) -> torch.Tensor:
    """Whether the tip has come back to the anal verge: the scope is out, bool, shape (N,).

    Args:
        arc_length: Arc length of the tip at which it counts as out [m].
    """
    return env.scene["endoscope"].data.tip_arc_length < arc_length


@reads_no_sensor
@expects(towards=("anus", "cecum"), angle=Range(0.0, math.pi), after_s=Range(0.0))
def facing(env: ManagerBasedRLEnv, towards: str = "cecum", angle: float = 1.05, after_s: float = 10.0) -> torch.Tensor:
    """Whether the tip looks along the lumen towards one of its ends, bool, shape (N,).

    A capsule can turn round in the lumen. What it sees then looks like the way ahead, so that a policy without a memory
    goes the wrong way: end such episodes in training, and it learns not to turn.

    Args:
        towards: ``cecum``, or ``anus``.
        angle: Largest angle between the tip's axis and the lumen's direction towards that end [rad].
        after_s: Time from the start of an episode in which it may look where it likes [s].
    """
    along = tip_lumen_direction(env)[:, 2]
    looks = (along if towards == "cecum" else -along) > math.cos(angle)
    return looks & (env.episode_length_buf * env.step_dt > after_s)


@reads_no_sensor
@expects(limit=FINITE)
def episode_cost_above(env: ManagerBasedRLEnv, limit: float, cost: str | None = None) -> torch.Tensor:
    """Whether an episode's cost has exceeded its limit up to the last step, bool, shape (N,).

    The early termination that constrained algorithms are compared with. The cost of a step is known after the
    terminations of that step, so that the episode ends one step later.

    Args:
        limit: Largest cost of an episode, as ``Episode_Cost/...`` is logged.
        cost: Name of the cost term; None takes the sum of all.

    Raises:
        ValueError: If the task has no such cost.
    """
    manager = getattr(env, "cost_manager", None)
    if manager is None:  # the first evaluation, which only looks at the shape, comes before the costs
        return torch.zeros(env.num_envs, dtype=torch.bool, device=env.device)
    sums = manager.episode_sums
    if cost is not None and cost not in sums:
        raise ValueError(f"episode_cost_above names the cost '{cost}', expected one of: {', '.join(sums)}.")
    return (sum(sums.values(), torch.zeros(env.num_envs, device=env.device)) if cost is None else sums[cost]) > limit


@reads_no_sensor
def wall_penetrated(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Whether a link is going through the wall, bool, shape (N,).

    The episode must end: the wall does not tear, and its later forces mean nothing.

    It takes a full push that is kept on and coils the shaft, or one with the shaft twisted to its limit; in soft tissue
    some 15 N on the tip may do it by a flutter of the time step. A bend drawn to a hairpin, whose walls go through each
    other, may do it at a few newtons (docs/clinical.md, what pierces).
    """
    return env.sim.wall_penetrated


@expects(threshold=FINITE, steps=Range(1), lumen=LUMEN_PRESETS)
class lumen_not_visible(ManagerTermBase):
    """Whether the visibility ``s_o`` has been low for some control steps in a row, bool, shape (N,)."""

    def __init__(self, cfg: TerminationTermCfg, env: ManagerBasedRLEnv) -> None:
        """Start every world's count at zero."""
        super().__init__(cfg, env)
        self._count = torch.zeros(env.num_envs, dtype=torch.long, device=env.device)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Start the count of the given worlds again."""
        fill_worlds(self._count, env_ids, 0)

    def __call__(
        self, env: ManagerBasedRLEnv, threshold: float = -0.4, steps: int = 5, lumen: str | LumenCfg | None = None
    ) -> torch.Tensor:
        """Count the steps without lumen.

        Args:
            threshold: Visibility below which the lumen is lost, in [-1, 1]; the default is the original code's for its
                unconstrained agents.
            steps: Control steps in a row.
            lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
        """
        lost = lumen_scores(env, lumen).s_o < threshold
        self._count = (self._count + 1) * lost
        return self._count >= steps


@reads_no_sensor
@expects(window_s=POSITIVE, min_progress=FINITE)
class stuck(ManagerTermBase):
    """Whether the tip has hardly advanced over the last seconds, bool, shape (N,).

    A pull-back to straighten the shaft also looks like this while it lasts, so the window must leave time for one. As a
    truncation (``time_out=True``) it lets a policy take the view's reward to go on for ever, and wait.
    """

    def __init__(self, cfg: TerminationTermCfg, env: ManagerBasedRLEnv) -> None:
        """Allocate the ring buffer of past positions, shape (window, N)."""
        super().__init__(cfg, env)
        window = max(1, round(cfg.params["window_s"] / env.step_dt))
        self._arc = torch.full((window, env.num_envs), -torch.inf, device=env.device)
        self._next = 0

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget the past of the given worlds; they cannot be stuck before a whole window has passed."""
        fill_worlds(self._arc, env_ids, -torch.inf, dim=1)

    def __call__(self, env: ManagerBasedRLEnv, window_s: float, min_progress: float) -> torch.Tensor:
        """Compare the tip's arc length with the one of a window ago.

        Args:
            window_s: Length of the window [s], read once at construction.
            min_progress: Advance over the window below which the tip is stuck [m].
        """
        arc = env.scene["endoscope"].data.tip_arc_length
        advance = arc - self._arc[self._next]
        self._arc[self._next] = arc
        self._next = (self._next + 1) % len(self._arc)
        return advance < min_progress
