# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Where the lumen leads, seen from the tip. N worlds."""

from __future__ import annotations

import math

import torch

from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.utils.math import normalize, points_at, quat_apply, quat_apply_inverse, row_sum


def lumen_direction(scene: InteractiveScene, ahead: float) -> torch.Tensor:
    """Return the unit vector from the tip to the centerline ``ahead`` [m] of it, in the tip's frame, shape (N, 3)."""
    data, colon = scene["endoscope"].data, scene["colon"].data
    arc = data.tip_arc_length[:, None] + ahead
    target = points_at(colon.centerline_pos_w, colon.centerline_arc, arc)[:, 0]
    local = quat_apply_inverse(data.tip_quat_w, target - data.tip_pos_w)
    return normalize(local)


def tip_angle(scene: InteractiveScene) -> torch.Tensor:
    """Return the angle between the tip's axis and the centerline beside it [deg], shape (N,)."""
    data = scene["endoscope"].data
    forward = torch.zeros_like(data.tip_pos_w)
    forward[:, 2] = 1.0
    cosine = row_sum(quat_apply(data.tip_quat_w, forward) * data.tip_lumen_direction_w)
    return torch.acos(cosine.clamp(-1.0, 1.0)) * (180.0 / math.pi)
