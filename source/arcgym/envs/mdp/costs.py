# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Cost terms ``(env, **params) -> (N,)`` for constrained learning; the environment sums them in ``extras["cost"]``.

Loads are means over the control step; with ``peak`` the largest of its physics steps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.loads import anchor_load, force_limit, link_load, strain_load, tip_load
from arcgym.envs.mdp.lumen import LumenCfg, lumen_scores, resolve_lumen
from arcgym.envs.mdp.settings import task_setting
from arcgym.managers import SceneEntityCfg

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

_ENDOSCOPE = SceneEntityCfg("endoscope")


def tip_force_above(env: ManagerBasedRLEnv, limit: float | str = "unsafe", peak: bool = False) -> torch.Tensor:
    """1 when the tip presses on the wall with more than ``limit`` ([N] or a tier)."""
    return (tip_load(env, peak) > force_limit(env, limit)).float()


def wall_force_above(
    env: ManagerBasedRLEnv,
    limit: float | str = "unsafe",
    asset_cfg: SceneEntityCfg = _ENDOSCOPE,
    peak: bool = False,
) -> torch.Tensor:
    """1 when some link presses on the wall with more than ``limit`` ([N] or a tier)."""
    return (link_load(env, asset_cfg, peak).amax(dim=1) > force_limit(env, limit)).float()


def wall_strain_above(env: ManagerBasedRLEnv, limit: float = 0.5, peak: bool = False) -> torch.Tensor:
    """1 when the wall is stretched by more than ``limit`` anywhere.

    Colon tore at strains near 1.8 (Egorov et al. 2002, transverse strips); no safe limit in vivo is published.
    """
    return (strain_load(env, peak).amax(dim=1) > limit).float()


def anchor_tension_above(env: ManagerBasedRLEnv, limit: float, peak: bool = False) -> torch.Tensor:
    """1 when some ring pulls on its anchors, the mesentery, with more than ``limit`` [N].

    No safe limit is published.
    """
    return (anchor_load(env, peak).amax(dim=1) > limit).float()


def view_blocked(
    env: ManagerBasedRLEnv, distance: float | None = None, lumen: str | LumenCfg | None = None
) -> torch.Tensor:
    """1 when nothing in view is farther than ``distance`` [m]: a red-out. None takes ``tau_wall`` of the reward."""
    cfg = resolve_lumen(task_setting(env, "lumen", lumen))
    limit = cfg.tau_wall if distance is None else distance
    return (lumen_scores(env, cfg).depth_max < limit).float()
