# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Arc-length interval of a colon segment, as the terms need it."""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import torch

from arcgym.envs.mdp.settings import task_setting

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


def segment_span(env: ManagerBasedEnv, segment: str | None = None) -> tuple[float, float]:
    """Start and end of a segment, rest arc length from the anal verge [m].

    Args:
        env: The environment; its scene holds ``colon``.
        segment: A name of :data:`arcgym.anatomy.segments.SEGMENTS`. None takes the task's, ``env.cfg.segment``.
    """
    name = task_setting(env, "segment", segment)
    if env not in _BOUNDS:
        _BOUNDS[env] = env.scene["colon"].stage.segment_bounds()
    bounds = _BOUNDS[env]
    if name not in bounds:
        raise KeyError(f"Segment '{name}' is not in this colon. Available: {list(bounds)}.")
    return bounds[name]


def segment_progress(env: ManagerBasedEnv, segment: str | None = None) -> torch.Tensor:
    """Way of the tip through the segment: 0 at its start, 1 at its end, not clamped, shape (N,).

    Measured by arc length along the lumen. The straight distance to the end would count a tip in a neighbouring loop.
    """
    start, end = segment_span(env, segment)
    return (env.scene["endoscope"].data.tip_arc_length - start) / (end - start)


def has_passed(env: ManagerBasedEnv, segment: str | None = None) -> torch.Tensor:
    """Whether the tip has reached the end of the segment, by arc length along the lumen, bool, shape (N,)."""
    _, end = segment_span(env, segment)
    return env.scene["endoscope"].data.tip_arc_length >= end


_BOUNDS: WeakKeyDictionary[ManagerBasedEnv, dict[str, tuple[float, float]]] = WeakKeyDictionary()
