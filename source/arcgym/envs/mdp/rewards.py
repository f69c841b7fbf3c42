# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Reward terms ``(env, **params) -> (N,)``; the manager multiplies each by its weight and the control step [s]."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.loads import anchor_load, force_limit, link_load, strain_load, tip_load
from arcgym.envs.mdp.lumen import LumenCfg, lumen_scores
from arcgym.envs.mdp.segments import has_passed
from arcgym.managers import ManagerTermBase, RewardTermCfg, SceneEntityCfg
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

_ENDOSCOPE = SceneEntityCfg("endoscope")


def lumen_centering(env: ManagerBasedRLEnv, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """Centring ``s_c`` of the lumen in the image, in [0, 1]."""
    return lumen_scores(env, lumen).s_c


def lumen_visibility(env: ManagerBasedRLEnv, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """Visibility ``s_o`` of the lumen, in [-1, 1]."""
    return lumen_scores(env, lumen).s_o


def lumen_reward(env: ManagerBasedRLEnv, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """The paper's reward ``R = w_c s_c + w_o s_o``, see :mod:`arcgym.envs.mdp.lumen`."""
    return lumen_scores(env, lumen).reward


class progress(ManagerTermBase):
    """Advance of the tip along the lumen in this control step [m], negative when it slips back.

    The first step of an episode counts as zero: what the tip did before is not known.
    """

    def __init__(self, cfg: RewardTermCfg, env: ManagerBasedRLEnv) -> None:
        """Forget every world's previous position."""
        super().__init__(cfg, env)
        self._previous = torch.full((env.num_envs,), torch.nan, device=env.device)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget the previous position of the given worlds."""
        fill_worlds(self._previous, env_ids, torch.nan)

    def __call__(self, env: ManagerBasedRLEnv) -> torch.Tensor:
        """Return the change of the tip's arc length since the last call [m]."""
        arc = env.scene["endoscope"].data.tip_arc_length
        change = torch.nan_to_num(arc - self._previous, nan=0.0)
        self._previous.copy_(arc)
        return change


def success(env: ManagerBasedRLEnv, segment: str | None = None) -> torch.Tensor:
    """1 when the tip has passed the end of the segment."""
    return has_passed(env, segment).float()


def tip_force_l2(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Squared force between tip and wall [N^2], mean over the control step."""
    return env.scene["endoscope"].data.tip_force.square()


def excess_tip_force(env: ManagerBasedRLEnv, limit: float | str = "comfort", peak: bool = False) -> torch.Tensor:
    """Force between tip and wall above ``limit`` ([N] or a tier) [N], mean over the control step or its peak."""
    return (tip_load(env, peak) - force_limit(env, limit)).clamp(min=0.0)


def excess_wall_force(
    env: ManagerBasedRLEnv,
    limit: float | str = "comfort",
    asset_cfg: SceneEntityCfg = _ENDOSCOPE,
    peak: bool = False,
) -> torch.Tensor:
    """Largest force between a link and the wall above ``limit`` ([N] or a tier) [N], mean over the step or its peak."""
    return (link_load(env, asset_cfg, peak).amax(dim=1) - force_limit(env, limit)).clamp(min=0.0)


def excess_wall_strain(env: ManagerBasedRLEnv, limit: float = 0.2, peak: bool = False) -> torch.Tensor:
    """Largest strain of the wall above ``limit``, mean over the control step or its peak."""
    return (strain_load(env, peak).amax(dim=1) - limit).clamp(min=0.0)


def excess_anchor_tension(env: ManagerBasedRLEnv, limit: float, peak: bool = False) -> torch.Tensor:
    """Largest pull of a ring on its anchors, the mesentery, above ``limit`` [N], mean over the step or its peak."""
    return (anchor_load(env, peak).amax(dim=1) - limit).clamp(min=0.0)


def action_rate_l2(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Squared change of the raw action since the last step."""
    return (env.action_manager.action - env.action_manager.prev_action).square().sum(dim=1)


def action_l2(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Squared raw action."""
    return env.action_manager.action.square().sum(dim=1)


def is_terminated(env: ManagerBasedRLEnv) -> torch.Tensor:
    """1 when the episode ends other than by its time limit."""
    return env.termination_manager.terminated.float()
