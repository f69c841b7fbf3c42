# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Cost terms ``(env, **params) -> (N,)`` for constrained learning; the environment sums them in ``extras["cost"]``.

Costs of force, strain and pull are in :mod:`arcgym.envs.mdp.loads`; what is true counts as one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.lumen import LUMEN_PRESETS, LumenCfg, lumen_scores, resolve_lumen
from arcgym.envs.mdp.settings import task_setting
from arcgym.utils.validation import NON_NEGATIVE, expects

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

__all__ = ["view_blocked"]


@expects(distance=NON_NEGATIVE, lumen=LUMEN_PRESETS)
def view_blocked(
    env: ManagerBasedRLEnv, distance: float | None = None, lumen: str | LumenCfg | None = None
) -> torch.Tensor:
    """Whether nothing in view is farther than a distance: a red-out, bool, shape (N,).

    Args:
        distance: Largest depth that still counts as wall [m]; None takes ``tau_wall`` of the lumen scores.
        lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
    """
    cfg = resolve_lumen(task_setting(env, "lumen", lumen))
    limit = cfg.tau_wall if distance is None else distance
    return lumen_scores(env, cfg).depth_max < limit
