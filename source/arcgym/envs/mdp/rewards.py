# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Reward terms ``(env, **params) -> (N,)``; the manager multiplies each by its weight and the control step [s].

Penalties of force, strain and pull are in :mod:`arcgym.envs.mdp.loads`, the bonus of success in
:mod:`arcgym.envs.mdp.segments`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.centerline import points_ahead
from arcgym.envs.mdp.lumen import LUMEN_PRESETS, LumenCfg, lumen_scores, resolve_lumen, score_depth
from arcgym.envs.mdp.settings import task_setting
from arcgym.managers import ManagerTermBase, RewardTermCfg
from arcgym.sensors.depth_estimators import EstimatedDepth, TransformersDepth
from arcgym.utils.math import row_sum
from arcgym.utils.validation import POSITIVE, expects
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

__all__ = [
    "action_l2",
    "action_rate_l2",
    "estimated_lumen_reward",
    "is_terminated",
    "lumen_centering",
    "lumen_lost",
    "lumen_misalignment",
    "lumen_part",
    "lumen_reward",
    "lumen_visibility",
    "progress",
]


PARTS = ("s_c", "s_1", "s_2", "s_3", "s_o")
"""Parts of the paper's reward, see :mod:`arcgym.envs.mdp.lumen`."""


@expects(lumen=LUMEN_PRESETS)
def lumen_centering(env: ManagerBasedRLEnv, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """Centering ``s_c`` of the lumen in the image, in [0, 1], shape (N,).

    Args:
        lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
    """
    return lumen_scores(env, lumen).s_c


@expects(lumen=LUMEN_PRESETS)
def lumen_visibility(env: ManagerBasedRLEnv, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """Visibility ``s_o`` of the lumen, in [-1, 1], shape (N,).

    Args:
        lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
    """
    return lumen_scores(env, lumen).s_o


@expects(lumen=LUMEN_PRESETS)
def lumen_reward(env: ManagerBasedRLEnv, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """Return the paper's reward ``R = w_c s_c + w_o s_o``, see :mod:`arcgym.envs.mdp.lumen`, shape (N,).

    Args:
        lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
    """
    return lumen_scores(env, lumen).reward


@expects(lumen=LUMEN_PRESETS)
def lumen_lost(env: ManagerBasedRLEnv, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """Visibility ``s_o`` where it is negative, else 0: in [-1, 0], shape (N,).

    In place of ``lumen_reward`` it makes looking at a wall costly without paying for a view, for which policies may
    wait at a discount near one.

    Args:
        lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
    """
    return lumen_scores(env, lumen).s_o.clamp(max=0.0)


@expects(ahead=POSITIVE)
def lumen_misalignment(env: ManagerBasedRLEnv, ahead: float = 0.03) -> torch.Tensor:
    """``1 - cos`` of the angle between the tip's axis and the way to the centerline ahead, in [0, 2], shape (N,).

    A price, with a negative weight, on looking elsewhere than along the lumen. It is privileged: in a tight bend the
    near wall counts as lumen in the image, so that the paper's reward pays for looking away from the way on.

    Args:
        ahead: Arc length from the tip to the point of the deformed centerline that it should look at [m].
    """
    return 1.0 - torch.nn.functional.normalize(points_ahead(env, ahead)[:, 0], dim=-1)[:, 2]


@expects(part=PARTS, lumen=LUMEN_PRESETS)
def lumen_part(env: ManagerBasedRLEnv, part: str, lumen: str | LumenCfg | None = None) -> torch.Tensor:
    """One part of the paper's reward alone, as in its ablation, shape (N,).

    Args:
        part: One of :data:`PARTS`.
        lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
    """
    return getattr(lumen_scores(env, lumen), part)


class estimated_lumen_reward(ManagerTermBase):
    """The paper's reward on depth that a network estimates from the color image, shape (N,).

    Costs, terminations and metrics keep the simulator's depth, so that results stay comparable. In place of
    ``lumen_reward`` it shows whether a reward that a real endoscope could give is enough to learn from.
    """

    def __init__(self, cfg: RewardTermCfg, env: ManagerBasedRLEnv) -> None:
        """Load the network.

        Raises:
            UsageError: The folder or the package ``transformers`` is missing.
        """
        super().__init__(cfg, env)
        values = dict(cfg.params)
        network = TransformersDepth(values["weights"], env.device, gives_depth=values.get("gives_depth", False))
        ranges = {name: values[name] for name in ("near", "far") if name in values}
        self._depth = EstimatedDepth(env, network, **ranges)

    def __call__(
        self,
        env: ManagerBasedRLEnv,
        weights: str,
        gives_depth: bool = False,
        near: float = 0.003,
        far: float = 0.1,
        lumen: str | LumenCfg | None = None,
    ) -> torch.Tensor:
        """Score the estimate of the current images.

        Args:
            weights: Folder with the network in the format of transformers; read once at construction.
            gives_depth: Whether it answers with depth, as metric variants do, and not with its inverse; read once.
            near: Depth that the nearest pixel of every frame is given [m], since estimates have no scale; read once.
            far: Depth that the farthest pixel of every frame is given [m]; read once.
            lumen: Constants of the scores, or a preset's name; None takes the task's, ``env.cfg.lumen``.
        """
        return score_depth(self._depth(), resolve_lumen(task_setting(env, "lumen", lumen))).reward


class progress(ManagerTermBase):
    """Advance of the tip along the lumen in this control step [m], negative when it slips back, shape (N,).

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


def action_rate_l2(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Squared change of the raw action since the last step, summed over its entries, shape (N,)."""
    return row_sum((env.action_manager.action - env.action_manager.prev_action).square())


def action_l2(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Squared raw action, summed over its entries, shape (N,)."""
    return row_sum(env.action_manager.action.square())


def is_terminated(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Whether the episode ends other than by its time limit, bool, shape (N,)."""
    return env.termination_manager.terminated
