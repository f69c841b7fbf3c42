# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A colon segment: its interval of arc length, the way through it, and success, for every kind of term."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.anatomy.segments import SEGMENTS
from arcgym.envs.mdp.settings import task_setting
from arcgym.managers import reads_no_sensor
from arcgym.utils.validation import expects

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

__all__ = ["segment_progress", "segment_span", "success"]

WITHDRAWN_ARC = 0.05
"""Arc length at which a withdrawal is complete [m]: the tip is in the lower rectum, above the anal canal."""


CECUM_REACHED = 0.5
"""Share of the cecum that lies behind the tip when it counts as reached: half of the way from the ileocecal valve,
where the segment begins, to the blind end.

Cecal intubation is the "passage of the colonoscope tip to a point proximal to the ileocecal valve, so that the entire
cecal caput", with the wall between valve and appendix, "is visible" (Rex et al., Gastrointest. Endosc. 81:31, 2015).
The valve lies about 6 cm before the blind end (Gray's Anatomy), so this is 3 cm past the valve. The depth is our
choice: a tip that has a size cannot reach the end of the centerline.
"""


def is_withdrawal(env: ManagerBasedEnv) -> bool:
    """Return whether the task's goal is the anus (``env.cfg.direction`` is ``withdrawal``)."""
    return getattr(env.cfg, "direction", "insertion") == "withdrawal"


def segment_span(env: ManagerBasedEnv, segment: str | None = None) -> tuple[torch.Tensor, torch.Tensor]:
    """Return start and end of a segment in each world's patient, rest arc length from the anal verge [m], shape (N,).

    They are views that follow the patients; copy them to keep them.

    Args:
        env: The environment; its scene holds ``colon``.
        segment: A name of :data:`arcgym.anatomy.segments.SEGMENTS`. None takes the task's, ``env.cfg.segment``, which
            begins at the anus where the episode does (``env.cfg.start`` is ``rest``). A withdrawal's begins where the
            segment does and ends at :data:`WITHDRAWN_ARC`, below it.

    Raises:
        ValueError: If a patient does not have the segment, with those it has.
    """
    name = task_setting(env, "segment", segment)
    colon = env.scene["colon"]
    colon.require_segment(name)
    start, end = colon.data.segment_spans[:, SEGMENTS.index(name)].unbind(dim=1)
    if segment is None and is_withdrawal(env):
        return start, torch.full_like(end, WITHDRAWN_ARC)
    begins_at_anus = segment is None and getattr(env.cfg, "start", None) == "rest"
    return torch.zeros_like(start) if begins_at_anus else start, end


@expects(segment=SEGMENTS)
def segment_progress(env: ManagerBasedEnv, segment: str | None = None) -> torch.Tensor:
    """Way of the tip through the segment: 0 at its start, 1 at its end, not clamped, shape (N,).

    Measured by arc length along the lumen. The straight distance to the end would count a tip in a neighboring loop.

    Args:
        segment: Name of the segment; None takes the task's, ``env.cfg.segment``.
    """
    start, end = segment_span(env, segment)
    return (env.scene["endoscope"].data.tip_arc_length - start) / (end - start)


@reads_no_sensor
@expects(segment=SEGMENTS)
def success(env: ManagerBasedEnv, segment: str | None = None) -> torch.Tensor:
    """Whether the tip has reached the end of the segment, by arc length along the lumen, bool, shape (N,).

    The cecum is reached at :data:`CECUM_REACHED` of its length; :func:`segment_progress` counts on to the blind end. A
    withdrawal ends below :data:`WITHDRAWN_ARC`.

    Args:
        segment: Name of the segment; None takes the task's, ``env.cfg.segment``.
    """
    _, end = segment_span(env, segment)
    arc = env.scene["endoscope"].data.tip_arc_length
    if segment is None and is_withdrawal(env):
        return arc <= end
    if task_setting(env, "segment", segment) == "cecum":
        valve = env.scene["colon"].data.segment_spans[:, SEGMENTS.index("cecum"), 0]
        end = torch.lerp(valve, end, CECUM_REACHED)
    return arc >= end
