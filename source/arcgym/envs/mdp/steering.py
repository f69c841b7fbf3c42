# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Steering of a pulled tip along the centerline, which no image shows: what a policy may be taught where it is lost."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.actions import TipVelocityAction
from arcgym.envs.mdp.centerline import points_ahead
from arcgym.managers import ManagerTermBase, ObservationTermCfg
from arcgym.utils.validation import NON_NEGATIVE, POSITIVE, expects
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

__all__ = ["steering_actions", "steering_lesson"]

FULL_TURN = 0.5
"""Angle from which on it turns with the whole range [rad]."""

FORWARD, NOT_BACK = 0.6, 0.2
"""Cosines of the angle to the way above which the tip goes forward, and below which it goes back."""

ADVANCE, RETREAT = 0.8, -0.6
"""Raw actions forward and back."""

PULLS, TURNS = slice(0, 3), slice(3, 5)
"""Columns of right, up and forward, and of pitch and yaw."""


def steering_actions(ahead: torch.Tensor) -> torch.Tensor:
    """Return raw actions of :class:`arcgym.envs.mdp.TipVelocityAction` that turn and pull a tip to a point.

    It turns to the point and moves aside towards it; forward where it looks there, back where it looks away.

    Args:
        ahead: A point of the way ahead in the tip frame (+Z forward) [m], shape (N, 3).

    Returns:
        Shape (N, 6): right, up, forward, pitch, yaw, and no roll.
    """
    x, y, z = torch.nn.functional.normalize(ahead, dim=-1).unbind(dim=-1)
    aside = torch.hypot(x, y).clamp(min=0.05)
    turn = (torch.atan2(aside, z) / FULL_TURN).clamp(0.0, 1.0) / aside
    forward = torch.where(z > FORWARD, ADVANCE, torch.where(z > NOT_BACK, 0.0, RETREAT))
    return torch.stack([x, y, forward, -y * turn, x * turn, torch.zeros_like(x)], dim=-1)


@expects(ahead=POSITIVE, wait_s=NON_NEGATIVE, new_way=NON_NEGATIVE, pull=NON_NEGATIVE, elsewhere=NON_NEGATIVE)
class steering_lesson(ManagerTermBase):
    """What to do where no way is made, for :class:`arcgym.rl.algorithms.ppo_taught.PPOTaught`: actions, then weights.

    Shape (N, 12): the actions of :func:`steering_actions`, and how much each is to be learnt. A tip is stuck once it
    has not come ``new_way`` beyond its farthest place for ``wait_s``; there pitch and yaw have weight 1, the three
    directions of the pull the weight ``pull``. Elsewhere pitch and yaw have the weight ``elsewhere``, so that a memory
    learns to hold the direction. The roll is never told.
    """

    def __init__(self, cfg: ObservationTermCfg, env: ManagerBasedEnv) -> None:
        """Begin with no way made.

        Raises:
            ValueError: If the robot's actions are not the six of :class:`arcgym.envs.mdp.TipVelocityAction`.
        """
        super().__init__(cfg, env)
        terms = [env.action_manager.get_term(name) for name in env.action_manager.active_terms]
        names = tuple(axis for term in terms for axis in getattr(term, "axis_names", ()))
        if names != TipVelocityAction.axes:
            raise ValueError(
                f"steering_lesson is for the actions of a pulled tip, {', '.join(TipVelocityAction.axes)}; this task "
                f"has {', '.join(names) or 'others'}."
            )
        self._farthest = torch.full((env.num_envs,), -torch.inf, device=env.device)
        self._waited = torch.zeros(env.num_envs, device=env.device)
        self._step = -1

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget the way of the given worlds."""
        fill_worlds(self._farthest, env_ids, -torch.inf)
        fill_worlds(self._waited, env_ids, 0.0)

    def __call__(
        self,
        env: ManagerBasedEnv,
        ahead: float = 0.03,
        wait_s: float = 2.5,
        new_way: float = 0.005,
        pull: float = 0.3,
        elsewhere: float = 0.2,
    ) -> torch.Tensor:
        """Return the lesson; a second call in a control step gives the same.

        Args:
            ahead: Arc length ahead of the tip to which is steered [m].
            wait_s: Time without new way after which a tip is stuck [s].
            new_way: Advance beyond the farthest place that counts as new way [m].
            pull: Weight of right, up and forward where it is stuck.
            elsewhere: Weight of pitch and yaw where it is not.
        """
        self._watch(env, new_way)
        actions = steering_actions(points_ahead(env, ahead)[:, 0])
        stuck, weights = (self._waited > wait_s)[:, None], torch.zeros_like(actions)
        weights[:, PULLS] = pull * stuck
        weights[:, TURNS] = torch.where(stuck, 1.0, elsewhere)
        return torch.cat([actions, weights], dim=-1)

    def _watch(self, env: ManagerBasedEnv, new_way: float) -> None:
        """Count the time since new way was made."""
        arc = env.scene["endoscope"].data.tip_arc_length
        won = arc > self._farthest + new_way
        self._farthest = torch.where(won, arc, self._farthest)
        passed = env.step_dt * (env.common_step_counter != self._step)
        self._waited = torch.where(won, 0.0, self._waited + passed)
        self._step = env.common_step_counter
