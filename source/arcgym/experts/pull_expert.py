# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Expert for a tip that is pulled."""

from __future__ import annotations

import torch

from arcgym.experts.expert_base import ExpertBase
from arcgym.experts.lumen_ahead import lumen_direction
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.utils.math import quat_apply_inverse


class PullExpert(ExpertBase):
    """Pulls the tip towards the centerline ahead and turns it that way; backs off where it does not get on."""

    PATIENCE = 20
    """Control steps without 4 mm of progress after which the tip backs off."""
    RETREAT = 12
    """Control steps of backing off."""

    def __init__(self, scene: InteractiveScene, speed: float = 0.04, ahead: float = 0.035, turn_gain: float = 4.0):
        """Keep the settings.

        Args:
            scene: The scene.
            speed: Speed where the tip looks along the lumen [m/s]; 35 % of it where it looks across.
            ahead: Distance looked ahead [m].
            turn_gain: Angular velocity per sine of the angle to the target [rad/s].
        """
        super().__init__(scene, speed)
        self.ahead, self.turn_gain = ahead, turn_gain
        self._furthest = torch.full((scene.num_envs,), -1.0, device=scene.device)
        self._waited = torch.zeros(scene.num_envs, dtype=torch.long, device=scene.device)
        self._retreat = torch.zeros_like(self._waited)

    def act(self) -> None:
        """Set the velocity commands."""
        self._watch_progress()
        data = self.scene["endoscope"].data
        direction = lumen_direction(self.scene, self.ahead)
        pace = self.speed * (0.35 + 0.65 * direction[:, 2:].clamp(min=0.0))
        back = quat_apply_inverse(data.tip_quat_w, -self.speed * data.tip_lumen_direction_w)
        forward = torch.zeros_like(direction)
        forward[:, 2] = 1.0
        turn = self.turn_gain * torch.linalg.cross(forward, direction)
        velocity = torch.where(self._retreat[:, None] > 0, back, pace * direction)
        self.scene["endoscope"].set_tip_velocity_command(velocity, turn)

    def reset(self, env_ids: torch.Tensor) -> None:
        """Forget how far some worlds came."""
        self._furthest[env_ids] = -1.0
        self._waited[env_ids] = 0
        self._retreat[env_ids] = 0

    def _watch_progress(self) -> None:
        arc = self.scene["endoscope"].data.tip_arc_length
        gained = arc > self._furthest + 0.004
        self._furthest = torch.where(gained, arc, self._furthest)
        self._waited = torch.where(gained, 0, self._waited + 1)
        self._retreat = (self._retreat - 1).clamp(min=0)
        tired = self._waited > self.PATIENCE
        self._retreat = torch.where(tired, self.RETREAT, self._retreat)
        self._waited = torch.where(tired, -self.RETREAT, self._waited)
