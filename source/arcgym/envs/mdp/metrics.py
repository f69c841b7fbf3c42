# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Metric terms ``(env, **params) -> (N,)``: figures that an episode is judged by.

The config says how the steps of an episode are reduced. Terms of other kinds serve as metrics too, such as
:func:`~arcgym.envs.mdp.segments.success` (reduce: max) and :func:`~arcgym.envs.mdp.rewards.lumen_centering` (mean).
Metrics of loads are in :mod:`arcgym.envs.mdp.load_metrics`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.anatomy.segments import SEGMENTS
from arcgym.envs.mdp.lumen import LUMEN_PRESETS, LumenCfg, lumen_scores
from arcgym.envs.mdp.segments import segment_progress, segment_span, success
from arcgym.utils.validation import FINITE, expects

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

__all__ = [
    "centered_rate",
    "centerline_distance",
    "inserted_scope",
    "looping_ratio",
    "mean_speed",
    "patient_index",
    "progress_fraction",
    "time_to_success",
    "visible_rate",
]


@expects(segment=SEGMENTS)
def time_to_success(env: ManagerBasedRLEnv, segment: str | None = None) -> torch.Tensor:
    """Episode time [s]; the time limit counts for an episode that has not succeeded, shape (N,) (reduce: last).

    Args:
        segment: Name of the segment; None takes the task's, ``env.cfg.segment``.
    """
    passed = success(env, segment)
    return torch.where(passed, env.episode_length_buf, env.max_episode_length) * env.step_dt


@expects(segment=SEGMENTS)
def progress_fraction(env: ManagerBasedRLEnv, segment: str | None = None) -> torch.Tensor:
    """Fraction of the segment behind the tip, in [0, 1], shape (N,) (reduce: max).

    Args:
        segment: Name of the segment; None takes the task's, ``env.cfg.segment``.
    """
    return segment_progress(env, segment).clamp(0.0, 1.0)


@expects(threshold=FINITE, lumen=LUMEN_PRESETS)
def centered_rate(env: ManagerBasedRLEnv, threshold: float = 0.8, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """Whether the lumen is in the middle of the image, bool, shape (N,) (reduce: mean).

    Args:
        threshold: Centering ``s_c`` from which on it is, in [0, 1]; the default is the original evaluation's.
        lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
    """
    return lumen_scores(env, lumen).s_c > threshold


@expects(threshold=FINITE, lumen=LUMEN_PRESETS)
def visible_rate(env: ManagerBasedRLEnv, threshold: float = -0.15, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """Whether the lumen is in view, bool, shape (N,) (reduce: mean).

    Args:
        threshold: Visibility ``s_o`` from which on it is, in [-1, 1]; the default is the original evaluation's.
        lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
    """
    return lumen_scores(env, lumen).s_o > threshold


def centerline_distance(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Distance of the tip from the deformed centerline [m], shape (N,) (reduce: mean, the trajectory error)."""
    return env.scene["endoscope"].data.tip_centerline_distance


def inserted_scope(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Length of scope inside the anus [m], shape (N,) (reduce: max, or last)."""
    return env.scene["endoscope"].data.inserted_length


def looping_ratio(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Return the inserted length over the tip's arc length, shape (N,) (reduce: last).

    Above one the shaft has formed loops. Arc lengths below 1 cm count as 1 cm.
    """
    data = env.scene["endoscope"].data
    return data.inserted_length / data.tip_arc_length.clamp(min=0.01)


@expects(segment=SEGMENTS)
def mean_speed(env: ManagerBasedRLEnv, segment: str | None = None) -> torch.Tensor:
    """Way made in the segment over the episode's time [m/s], shape (N,) (reduce: last).

    Args:
        segment: Name of the segment; None takes the task's, ``env.cfg.segment``.
    """
    start, end = segment_span(env, segment)
    advance = (env.scene["endoscope"].data.tip_arc_length - start) * (end - start).sign()
    return advance / (env.episode_length_buf.clamp(min=1) * env.step_dt)


def patient_index(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Return the number of the world's patient, an index into ``colon.patients``, shape (N,) (reduce: last)."""
    return env.scene["colon"].data.patient.float()
