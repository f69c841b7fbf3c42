# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""One moment of a world, copied to the host so that it can be drawn while the next one is computed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp

from arcgym.assets.force_tiers import tiers_of
from arcgym.viewers.frame_info import FrameInfo, read_info
from arcgym.viewers.palette import Tiers, force_tier, shown_tiers


@dataclass(frozen=True)
class Frame:
    """What a page shows of a world. V wall vertices, L links, K windows of scope."""

    number: int
    """Counts up with every frame."""
    nodal_pos: np.ndarray
    """Wall vertices [m], shape (V, 3)."""
    link_pos: np.ndarray
    """Middle of each link [m], shape (L, 3)."""
    link_quat: np.ndarray
    """Orientation of each link (x, y, z, w), shape (L, 4)."""
    window_force: np.ndarray
    """Force of the wall on each window of scope [N], shape (K,)."""
    camera_pose: np.ndarray
    """Position and quaternion of the camera at the tip, shape (7,)."""
    info: FrameInfo
    """Numbers of the world."""
    progress: float
    """Way through the task, 0 to 1; NaN where the task does not measure it."""
    looping: float
    """Looping ratio; NaN where the task does not measure it."""
    base_force: float
    """Push on the base [N]."""
    tier: str
    """Name of the tier of the force on the tip."""
    wall_strain: float = math.nan
    """Largest principal strain of a ring of the wall; NaN where it was not recorded."""
    anchor_tension: float = math.nan
    """Largest pull of a ring on its anchors [N]; NaN where it was not recorded."""
    lumen_pressure: float = math.nan
    """Pressure of the gas in the lumen [Pa]; NaN where there is none."""


def read_frame(env: Any, env_id: int, number: int) -> Frame:
    """Copy a world as it is now."""
    scope, colon = env.scene["endoscope"], env.scene["colon"]
    data, info = scope.data, read_info(env, env_id, None, ())
    tiers: Tiers = shown_tiers(tiers_of(env.cfg))
    metrics = env.metrics_manager.step_values
    pose = wp.to_torch(scope.camera_pose_wp)[env_id]
    return Frame(
        number,
        _host(colon.data.nodal_pos_w[env_id]),
        _host(data.body_pos_w[env_id]),
        _host(data.body_quat_w[env_id]),
        _host(data.window_force_norm[env_id]),
        _host(pose),
        info,
        float(metrics["progress"][env_id]) if "progress" in metrics else float("nan"),
        float(metrics["looping_ratio"][env_id]) if "looping_ratio" in metrics else float("nan"),
        float(data.base_force[env_id]),
        force_tier(info.tip_force, tiers).label,
        float(colon.data.wall_strain[env_id].max()),
        float(colon.data.anchor_tension[env_id].max()),
        math.nan if env.sim.gas is None else float(colon.data.lumen_pressure[env_id]),
    )


def _host(tensor: Any) -> np.ndarray:
    return tensor.detach().to("cpu", copy=True).numpy()
