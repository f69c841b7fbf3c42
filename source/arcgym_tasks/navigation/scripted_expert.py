# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Scripted experts that follow the deformed centreline: they make the start states and are a baseline.

They see what no camera sees, the centreline ahead of the tip. N worlds.
"""

from __future__ import annotations

import math
from typing import Protocol

import torch

from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.utils.math import quat_apply, quat_apply_inverse


class ScriptedExpert(Protocol):
    """Sets the commands of every world once a control step."""

    def act(self) -> None:
        """Look at the scene and set the endoscope's commands."""


def centerline_point(scene: InteractiveScene, arc: torch.Tensor) -> torch.Tensor:
    """Point of the deformed centreline at rest arc length ``arc`` [m], shape (N,); returns [m], shape (N, 3)."""
    data = scene["colon"].data
    knots = data.centerline_arc
    right = torch.searchsorted(knots, arc.contiguous()).clamp(1, len(knots) - 1)
    left = right - 1
    t = ((arc - knots[left]) / (knots[right] - knots[left])).clamp(0.0, 1.0)[:, None]
    world = torch.arange(len(arc), device=arc.device)
    points = data.centerline_pos_w
    return (1.0 - t) * points[world, left] + t * points[world, right]


def lumen_direction(scene: InteractiveScene, ahead: float) -> torch.Tensor:
    """Unit vector from the tip to the centreline ``ahead`` [m] of it, in the tip's frame, shape (N, 3)."""
    data = scene["endoscope"].data
    target = centerline_point(scene, data.tip_arc_length + ahead)
    local = quat_apply_inverse(data.tip_quat_w, target - data.tip_pos_w)
    return torch.nn.functional.normalize(local, dim=1)


class PullExpert:
    """Pulls the tip towards the centreline ahead and turns it that way; backs off where it does not get on."""

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
        self.scene, self.speed, self.ahead, self.turn_gain = scene, speed, ahead, turn_gain
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

    def _watch_progress(self) -> None:
        arc = self.scene["endoscope"].data.tip_arc_length
        gained = arc > self._furthest + 0.004
        self._furthest = torch.where(gained, arc, self._furthest)
        self._waited = torch.where(gained, 0, self._waited + 1)
        self._retreat = (self._retreat - 1).clamp(min=0)
        tired = self._waited > self.PATIENCE
        self._retreat = torch.where(tired, self.RETREAT, self._retreat)
        self._waited = torch.where(tired, -self.RETREAT, self._waited)


class PushExpert:
    """Steers the bending section towards the centreline ahead and pushes, slower where the lumen is off to a side."""

    def __init__(self, scene: InteractiveScene, speed: float = 0.04, ahead: float = 0.04, gain: float = 0.35):
        """Keep the settings.

        Args:
            scene: The scene.
            speed: Insertion speed while the lumen is ahead [m/s].
            ahead: Distance looked ahead [m].
            gain: Share of the angle to the target by which the command changes each step.
        """
        self.scene, self.speed, self.ahead, self.gain = scene, speed, ahead, gain
        self.largest = 2.9
        count = scene.num_envs
        self.bending = torch.zeros(count, 2, device=scene.device)
        self.velocity = torch.zeros(count, device=scene.device)

    def act(self) -> None:
        """Set bending and insertion commands."""
        direction = lumen_direction(self.scene, self.ahead)
        angle = torch.acos(direction[:, 2].clamp(-1.0, 1.0))
        error = torch.stack([-direction[:, 1], direction[:, 0]], dim=1)
        error = torch.nn.functional.normalize(error, dim=1) * angle[:, None]
        self.bending += self.gain * error
        norm = self.bending.norm(dim=1, keepdim=True)
        self.bending *= (self.largest / norm.clamp(min=1.0e-6)).clamp(max=1.0)
        pace = torch.where(angle < 0.5, 1.0, torch.where(angle < 1.0, 0.5, 0.15))
        self.velocity += (self.speed * pace - self.velocity).clamp(-0.03, 0.03)
        endoscope = self.scene["endoscope"]
        endoscope.set_bending_command(self.bending[:, 0], self.bending[:, 1])
        endoscope.set_insertion_command(self.velocity, torch.zeros_like(self.velocity))


def make_expert(scene: InteractiveScene, **settings: float) -> ScriptedExpert:
    """Expert that suits the scene's endoscope."""
    return (PushExpert if scene["endoscope"].kind == "proximal" else PullExpert)(scene, **settings)


def tip_angle(scene: InteractiveScene) -> torch.Tensor:
    """Angle between the tip's axis and the centreline beside it [deg], shape (N,)."""
    data = scene["endoscope"].data
    forward = torch.zeros_like(data.tip_pos_w)
    forward[:, 2] = 1.0
    cosine = (quat_apply(data.tip_quat_w, forward) * data.tip_lumen_direction_w).sum(dim=1)
    return torch.acos(cosine.clamp(-1.0, 1.0)) * (180.0 / math.pi)
