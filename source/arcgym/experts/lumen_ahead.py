# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Where the lumen leads, seen from the tip. N worlds."""

from __future__ import annotations

import torch

from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.utils.math import normalize, points_at, quat_apply_inverse


def lumen_direction(scene: InteractiveScene, ahead: float) -> torch.Tensor:
    """Return the unit vector from the tip to the centerline ``ahead`` [m] of it, in the tip's frame, shape (N, 3)."""
    data, colon = scene["endoscope"].data, scene["colon"].data
    arc = data.tip_arc_length[:, None] + ahead
    target = points_at(colon.centerline_pos_w, colon.centerline_arc, arc)[:, 0]
    local = quat_apply_inverse(data.tip_quat_w, target - data.tip_pos_w)
    return normalize(local)
