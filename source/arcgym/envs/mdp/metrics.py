# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Metric terms ``(env, **params) -> (N,)``: what an episode is judged by.

The config says how the steps of an episode are reduced. Reward terms of the same signature serve as metrics too, such
as :func:`~arcgym.envs.mdp.rewards.success` (reduce: max) and :func:`~arcgym.envs.mdp.rewards.lumen_centering` (mean).
Metrics of force and strain are in :mod:`arcgym.envs.mdp.force_metrics`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.lumen import LumenCfg, lumen_scores
from arcgym.envs.mdp.segments import has_passed, segment_progress, segment_span

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv


def time_to_success(env: ManagerBasedRLEnv, segment: str | None = None) -> torch.Tensor:
    """Episode time [s]; the time limit counts for an episode that has not succeeded (reduce: last)."""
    passed = has_passed(env, segment)
    return torch.where(passed, env.episode_length_buf, env.max_episode_length) * env.step_dt


def progress_fraction(env: ManagerBasedRLEnv, segment: str | None = None) -> torch.Tensor:
    """Fraction of the segment behind the tip, in [0, 1] (reduce: max)."""
    return segment_progress(env, segment).clamp(0.0, 1.0)


def centered_rate(env: ManagerBasedRLEnv, threshold: float = 0.8, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """1 while the lumen is in the middle of the image, ``s_c > 0.8`` as in the original evaluation (reduce: mean)."""
    return (lumen_scores(env, lumen).s_c > threshold).float()


def visible_rate(env: ManagerBasedRLEnv, threshold: float = -0.15, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """1 while the lumen is in view, ``s_o > -0.15`` as in the original evaluation (reduce: mean)."""
    return (lumen_scores(env, lumen).s_o > threshold).float()


def centerline_distance(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Distance of the tip from the deformed centreline [m]; its mean is the trajectory error (reduce: mean)."""
    return env.scene["endoscope"].data.tip_centerline_distance


def inserted_scope(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Length of scope inside the anus [m] (reduce: max, or last)."""
    return env.scene["endoscope"].data.inserted_length


def looping_ratio(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Inserted length over the tip's arc length (reduce: last). Above one the shaft has formed loops.

    Arc lengths below 1 cm count as 1 cm.
    """
    data = env.scene["endoscope"].data
    return data.inserted_length / data.tip_arc_length.clamp(min=0.01)


def mean_speed(env: ManagerBasedRLEnv, segment: str | None = None) -> torch.Tensor:
    """Way made in the segment over the episode's time [m/s] (reduce: last)."""
    start, _ = segment_span(env, segment)
    way = env.scene["endoscope"].data.tip_arc_length - start
    return way / (env.episode_length_buf.clamp(min=1) * env.step_dt)
