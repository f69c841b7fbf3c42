# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What the wall bears, as the terms need it: mean over the control step, or its peak, which lasts one physics step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.assets.force_tiers import tier_limit, tiers_of

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv
    from arcgym.managers import SceneEntityCfg


def link_load(env: ManagerBasedEnv, asset_cfg: SceneEntityCfg, peak: bool) -> torch.Tensor:
    """Force between each chosen link and the wall [N], shape (N, L); a view."""
    data = env.scene[asset_cfg.name].data
    return (data.wall_force_peak if peak else data.wall_force_norm)[:, asset_cfg.body_ids]


def tip_load(env: ManagerBasedEnv, peak: bool) -> torch.Tensor:
    """Force between the tip and the wall [N], shape (N,); a view."""
    data = env.scene["endoscope"].data
    return data.tip_force_peak if peak else data.tip_force


def strain_load(env: ManagerBasedEnv, peak: bool) -> torch.Tensor:
    """Largest principal strain of each ring of the wall, shape (N, R); a view."""
    data = env.scene["colon"].data
    return data.wall_strain_peak if peak else data.wall_strain


def anchor_load(env: ManagerBasedEnv, peak: bool) -> torch.Tensor:
    """Pull of each ring on its anchors [N], shape (N, R); a view."""
    data = env.scene["colon"].data
    return data.anchor_tension_peak if peak else data.anchor_tension


def force_limit(env: ManagerBasedEnv, limit: float | str) -> float:
    """Return a limit of force [N], given as a number or by the name of a tier of the task.

    Raises:
        ValueError: If there is no such tier, with those there are.
    """
    return tier_limit(tiers_of(env.cfg), limit)
