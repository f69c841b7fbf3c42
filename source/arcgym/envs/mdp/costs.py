# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Cost terms ``(env, **params) -> (N,)`` for constrained learning; the environment sums them in ``extras["cost"]``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.force_tiers import force_limit
from arcgym.envs.mdp.lumen import LumenCfg, lumen_scores, resolve_lumen
from arcgym.envs.mdp.settings import task_setting
from arcgym.managers import SceneEntityCfg

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

_ENDOSCOPE = SceneEntityCfg("endoscope")


def tip_force_above(env: ManagerBasedRLEnv, limit: float | str = "unsafe") -> torch.Tensor:
    """1 when the tip presses on the wall with more than ``limit`` ([N] or a tier), mean over the control step."""
    return (env.scene["endoscope"].data.tip_force > force_limit(env, limit)).float()


def wall_force_above(
    env: ManagerBasedRLEnv, limit: float | str = "unsafe", asset_cfg: SceneEntityCfg = _ENDOSCOPE
) -> torch.Tensor:
    """1 when some link presses on the wall with more than ``limit`` ([N] or a tier), mean over the control step."""
    force = env.scene[asset_cfg.name].data.wall_force_norm[:, asset_cfg.body_ids]
    return (force.amax(dim=1) > force_limit(env, limit)).float()


def wall_strain_above(env: ManagerBasedRLEnv, limit: float = 0.5) -> torch.Tensor:
    """1 when the wall is stretched by more than ``limit`` anywhere, mean over the control step.

    Colon tore at strains near 1.8 (Egorov et al. 2002, transverse strips); no safe limit in vivo is published.
    """
    return (env.scene["colon"].data.wall_strain.amax(dim=1) > limit).float()


def view_blocked(
    env: ManagerBasedRLEnv, distance: float | None = None, lumen: str | LumenCfg | None = None
) -> torch.Tensor:
    """1 when nothing in view is farther than ``distance`` [m]: a red-out. None takes ``tau_wall`` of the reward."""
    cfg = resolve_lumen(task_setting(env, "lumen", lumen))
    limit = cfg.tau_wall if distance is None else distance
    return (lumen_scores(env, cfg).depth_max < limit).float()
