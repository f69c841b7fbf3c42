# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Where the deformed centerline goes on from the tip, which no image shows: for observations and rewards."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.utils.math import points_at, quat_apply_inverse

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


def points_ahead(env: ManagerBasedEnv, ahead: torch.Tensor | float) -> torch.Tensor:
    """Return points of the deformed centerline in the tip frame (+Z forward) [m], shape (N, K, 3).

    Beyond the end of the centerline its last point is taken.

    Args:
        env: The environment.
        ahead: Arc lengths ahead of the tip [m], shape (K,), or one of them.
    """
    colon, data = env.scene["colon"].data, env.scene["endoscope"].data
    points = points_at(colon.centerline_pos_w, colon.centerline_arc, data.tip_arc_length[:, None] + ahead)
    return quat_apply_inverse(data.tip_quat_w[:, None], points - data.tip_pos_w[:, None])
