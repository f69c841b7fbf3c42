# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Cost terms ``(env, **params) -> (N,)`` for constrained learning; the environment sums them in ``extras["cost"]``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.lumen import LumenCfg, lumen_scores, resolve_lumen
from arcgym.envs.mdp.settings import task_setting

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv


def tip_force_above(env: ManagerBasedRLEnv, limit: float = 5.0) -> torch.Tensor:
    """1 when the tip presses on the wall with more than ``limit`` [N], mean over the control step.

    The unsafe tier of 5 N is a proposal: a third of the perforation force of a straight tip (Johnson et al. 2019).
    """
    return (env.scene["endoscope"].data.wall_force_w[:, -1].norm(dim=-1) > limit).float()


def view_blocked(
    env: ManagerBasedRLEnv, distance: float | None = None, lumen: str | LumenCfg | None = None
) -> torch.Tensor:
    """1 when nothing in view is farther than ``distance`` [m]: a red-out. None takes ``tau_wall`` of the reward."""
    cfg = resolve_lumen(task_setting(env, "lumen", lumen))
    limit = cfg.tau_wall if distance is None else distance
    return (lumen_scores(env, cfg).depth_max < limit).float()
