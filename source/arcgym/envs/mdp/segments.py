# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A colon segment: its interval of arc length, the way through it, and success, for every kind of term."""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import torch

from arcgym.anatomy.segments import SEGMENTS
from arcgym.envs.mdp.settings import task_setting
from arcgym.utils.string import did_you_mean
from arcgym.utils.validation import expects

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

__all__ = ["segment_progress", "segment_span", "success"]


def segment_span(env: ManagerBasedEnv, segment: str | None = None) -> tuple[float, float]:
    """Return start and end of a segment, rest arc length from the anal verge [m].

    Args:
        env: The environment; its scene holds ``colon``.
        segment: A name of :data:`arcgym.anatomy.segments.SEGMENTS`. None takes the task's, ``env.cfg.segment``.

    Raises:
        ValueError: If the colon does not have the segment, with those it has.
    """
    name = task_setting(env, "segment", segment)
    if env not in _BOUNDS:
        _BOUNDS[env] = env.scene["colon"].stage.segment_bounds()
    bounds = _BOUNDS[env]
    if name not in bounds:
        raise ValueError(f"Segment '{name}' is not in this colon. {did_you_mean(name, bounds)}")
    return bounds[name]


@expects(segment=SEGMENTS)
def segment_progress(env: ManagerBasedEnv, segment: str | None = None) -> torch.Tensor:
    """Way of the tip through the segment: 0 at its start, 1 at its end, not clamped, shape (N,).

    Measured by arc length along the lumen. The straight distance to the end would count a tip in a neighboring loop.

    Args:
        segment: Name of the segment; None takes the task's, ``env.cfg.segment``.
    """
    start, end = segment_span(env, segment)
    return (env.scene["endoscope"].data.tip_arc_length - start) / (end - start)


@expects(segment=SEGMENTS)
def success(env: ManagerBasedEnv, segment: str | None = None) -> torch.Tensor:
    """Whether the tip has reached the end of the segment, by arc length along the lumen, bool, shape (N,).

    Args:
        segment: Name of the segment; None takes the task's, ``env.cfg.segment``.
    """
    _, end = segment_span(env, segment)
    return env.scene["endoscope"].data.tip_arc_length >= end


_BOUNDS: WeakKeyDictionary[ManagerBasedEnv, dict[str, tuple[float, float]]] = WeakKeyDictionary()
