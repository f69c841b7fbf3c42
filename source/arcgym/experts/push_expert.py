# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Expert for a scope that is pushed and bent."""

from __future__ import annotations

import math
from typing import ClassVar

import torch

from arcgym.experts.expert_base import ExpertBase
from arcgym.experts.loops import Loops
from arcgym.experts.lumen_way import LumenWay, along
from arcgym.experts.retreat import Retreat
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.utils.math import norm, normalize, quat_apply_inverse

LARGEST_BENDING = 2.9
"""Largest bending commanded [rad]."""
JIGGLE_PERIOD = 10
"""Control steps of one pull and push."""
TWIST_PERIOD = 20
"""Control steps of one turn of the shaft to and fro."""

LOOPED = 0.2
"""Arc length that a world is behind by a length of scope in loops: one that has straightened gets on better."""


class PushExpert(ExpertBase):
    """Bends the tip towards the way that is open and pushes; withdraws where it does not get on.

    As an examiner does, it may jiggle the shaft and turn it to and fro, and where more scope goes in than the tip gets
    on, it pulls back until loops have straightened or the tip slips.
    """

    VARIED: ClassVar[dict[str, tuple[float, float]]] = {
        "speed": (0.015, 0.05),
        "look": (0.015, 0.05),
        "gain": (0.1, 0.5),
        "largest": (1.5, LARGEST_BENDING),
        "jiggle": (0.0, 0.03),
        "twist": (0.0, 9.0),
        "least_pace": (0.15, 0.8),
        "patience": (25.0, 120.0),
        "slack": (0.04, 0.4),
        "slips": (0.02, 0.1),
    }
    FREEING: ClassVar[tuple[str, ...]] = ("twist",)
    PERIOD = 40

    def __init__(
        self,
        scene: InteractiveScene,
        speed: float | torch.Tensor = 0.04,
        look: float = 0.035,
        gain: float = 0.35,
        largest: float = LARGEST_BENDING,
        jiggle: float = 0.0,
        twist: float = 0.0,
        least_pace: float = 0.4,
        patience: float = 60.0,
        slack: float = math.inf,
        slips: float = 0.025,
    ):
        """Keep the settings; each may be one number or one a world.

        Args:
            scene: The scene.
            speed: Insertion speed while the way is ahead [m/s]; a negative one withdraws.
            look: Length of way ahead that the tip is bent to [m].
            gain: Share of the angle to it by which the command changes each step.
            largest: Largest bending commanded [rad].
            jiggle: Amplitude of a to and fro of the shaft while it is pushed [m/s].
            twist: Amplitude of turning the shaft to and fro [rad/s]: a shaft that turns slides with less friction along
                its way. 8 rad/s, 150 degrees to either side, frees scopes that 43 N do not move (docs/experts.md).
            least_pace: Share of the speed at which it is pushed where the way is off to a side.
            patience: Control steps without progress after which it withdraws: until then the push grows.
            slack: Length of scope that may go into loops, beyond where it lay straightest, before it is pulled back to
                straighten them [m]; infinite for never.
            slips: Way that the tip may slip back while loops are straightened [m].
        """
        super().__init__(scene, speed)
        self.look, self.gain, self.largest = self.each(look), self.each(gain), self.each(largest)
        self.jiggle, self.twist = self.each(jiggle), self.each(twist)
        self.least_pace, self.patience, self.slack = self.each(least_pace), self.each(patience), self.each(slack)
        self.slips = self.each(slips)
        self.bending = torch.zeros(scene.num_envs, 2, device=scene.device)
        """Commanded pitch and yaw [rad], shape (N, 2)."""
        self.velocity = torch.zeros(scene.num_envs, device=scene.device)
        """Commanded insertion [m/s], shape (N,)."""
        self._way = LumenWay(scene)
        self._retreat = Retreat(scene.num_envs, scene.device, patience=self.patience, first=10, longest=60)
        self._loops = Loops(scene.num_envs, scene.device, self.slack, self.slips)
        self._turn = torch.zeros_like(self.velocity)
        self._steps = torch.zeros_like(self.velocity)

    def act(self) -> None:
        """Set bending and insertion commands."""
        backs, begins = self._pulls_back()
        self._turn = torch.where(begins, 1.2 * self.uniform("turn") - 0.6, self._turn)
        self._steps += 1.0
        angle = self._bend(torch.where(backs, 0.5, 1.0))
        pace = torch.maximum(torch.where(angle < 0.5, 1.0, torch.where(angle < 1.0, 0.5, 0.15)), self.least_pace)
        wanted = torch.where(backs, -self.speed, self.speed * pace)
        self.velocity += (wanted - self.velocity).clamp(-0.03, 0.03)
        jiggle = torch.where(backs, 0.0, self.jiggle) * (2.0 * math.pi / JIGGLE_PERIOD * self._steps).sin()
        turning = self.twist * (2.0 * math.pi / TWIST_PERIOD * self._steps).sin()
        endoscope = self.scene["endoscope"]
        endoscope.set_bending_command(self.bending[:, 0], self.bending[:, 1])
        endoscope.set_insertion_command(self.velocity + jiggle, torch.where(backs, self._turn, turning))

    def _pulls_back(self) -> tuple[torch.Tensor, torch.Tensor]:
        """Return which worlds are pulled back, and which begin to, both of shape (N,), bool."""
        data, inserts = self.scene["endoscope"].data, self.speed > 0.0
        backs, begins = self._retreat.update(data.tip_arc_length)
        straightens, starts = self._loops.update(data.tip_arc_length, data.inserted_length)
        return (backs | straightens) & inserts, (begins | starts) & inserts

    def reset(self, env_ids: torch.Tensor) -> None:
        """Take up the bending that some worlds start with, and stand still there."""
        self.bending[env_ids] = self.scene["endoscope"].data.bending[env_ids]
        self.velocity[env_ids] = 0.0
        self._steps[env_ids] = 0.0
        self._retreat.reset(env_ids)
        self._loops.reset(env_ids)

    def merit(self) -> torch.Tensor:
        """Return the arc length of the tip less a share of the scope that lies in loops [m], shape (N,)."""
        data = self.scene["endoscope"].data
        return data.tip_arc_length - LOOPED * (data.inserted_length - data.tip_arc_length)

    def memory(self) -> list[torch.Tensor]:
        """Return the commands of each world, and how far it came."""
        return [*self._retreat.memory, *self._loops.memory, self.bending, self.velocity, self._turn, self._steps]

    def _bend(self, share: torch.Tensor) -> torch.Tensor:
        """Bend towards the way by a share of the gain, shape (N,); return the angle to it [rad], shape (N,)."""
        data = self.scene["endoscope"].data
        target = along(self._way.find(), self.look) - data.tip_pos_w
        direction = normalize(quat_apply_inverse(data.tip_quat_w, target))
        direction = normalize(direction + 0.3 * self.disturbance)
        angle = torch.acos(direction[:, 2].clamp(-1.0, 1.0))
        error = torch.stack([-direction[:, 1], direction[:, 0]], dim=1)
        self.bending += (share * self.gain * angle)[:, None] * normalize(error)
        bent = norm(self.bending)
        self.bending *= (self.largest / bent.clamp(min=1.0e-6)).clamp(max=1.0)[:, None]
        return angle
