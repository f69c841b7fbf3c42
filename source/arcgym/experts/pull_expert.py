# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Expert for a tip that is pulled."""

from __future__ import annotations

import math
from typing import ClassVar

import torch

from arcgym.experts.expert_base import CONTROL_STEP, ExpertBase
from arcgym.experts.lumen_way import LumenWay, along
from arcgym.experts.retreat import Retreat
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.utils.math import norm, normalize, quat_apply_inverse, row_sum

REST_TIME, REST_PULL, REST_SPEED = 2.0, 0.3, 0.03
"""Time from one rest of the pull to the next [s], pull along the tip's axis meanwhile [N], and speed at which it gets
there, where the pull is off by 1 N or more [m/s]."""
TETHERED = 0.6
"""Length of tether inside from which it rolls and rests as told [m]; a shorter one rolls by that much less, so that the
torque is left for steering."""
SWEEP_RATE = 2.0
"""Rate at which a view circles around the way back [rad/s]: at a sweep of 0.8 rad it turns by 1.4 rad/s, of 1.5 that
actions allow."""


class PullExpert(ExpertBase):
    """Pulls the tip along the way that is open and turns it there; slides along what it touches, and backs off."""

    VARIED: ClassVar[dict[str, tuple[float, float]]] = {
        "speed": (0.02, 0.06),
        "look": (0.008, 0.03),
        "gaze": (0.01, 0.04),
        "turn_gain": (2.0, 10.0),
        "axis": (0.0, 0.8),
        "slide": (0.0, 1.0),
        "back": (0.0, 0.8),
        "roll": (0.0, 18.0),
        "roll_time": (2.0, 6.0),
        "rest": (-0.5, 0.5),
    }
    FREEING = ("roll", "roll_time")

    def __init__(
        self,
        scene: InteractiveScene,
        speed: float | torch.Tensor = 0.04,
        look: float = 0.02,
        gaze: float = 0.03,
        turn_gain: float = 4.0,
        axis: float = 0.5,
        slide: float = 1.0,
        back: float = 0.5,
        roll: float = 0.0,
        roll_time: float = 4.0,
        rest: float = 0.0,
        sweep: float = 0.0,
    ):
        """Keep the settings; each may be one number or one a world.

        Args:
            scene: The scene.
            speed: Speed where the tip looks along the way [m/s]; 35 % of it where it looks across. A negative one
                pulls the tip back along the lumen, its view kept on the way ahead.
            look: Length of way ahead that the tip is pulled to [m].
            gaze: Length of way ahead that it turns to [m].
            turn_gain: Angular velocity per sine of the angle to what it turns to [rad/s].
            axis: Share of the tip's own axis in the direction of the pull: a long head passes a bend lengthwise.
            slide: How much of the pull into what the tip touches is turned along it.
            back: How much the tip moves back along its axis while its front stands against a wall.
            roll: Amplitude of rolling the tip to and fro [rad/s], with 0.6 m of tether inside; less with less. A tether
                that rolls has less friction along its way. How far the tip turns is limited by its torque: more than
                that lets it turn as fast as it can.
            roll_time: Time of one roll to and fro [s]: a slower one goes farther down the tether.
            rest: Share of the time in which a tip with 0.6 m of tether inside hardly pulls, once in 2 s; none below 0.
                A tether that rolls without tension rolls farther down, and slides after.
            sweep: Angle between the view and the way ahead while the tip is pulled back [rad]: it circles around the
                way, and sees what lies behind folds. 0 looks straight along the way.
        """
        super().__init__(scene, speed)
        self.look, self.gaze, self.turn_gain = self.each(look), self.each(gaze), self.each(turn_gain)
        self.axis, self.slide, self.back = self.each(axis), self.each(slide), self.each(back)
        self.roll, self.roll_time = self.each(roll), self.each(roll_time)
        self.rest, self.sweep = self.each(rest), self.each(sweep)
        self._has_tether = scene["endoscope"].stage.root == "slide_roll"
        self._way = LumenWay(scene)
        self._retreat = Retreat(scene.num_envs, scene.device, patience=20, first=6, longest=40)
        self._side = torch.zeros(scene.num_envs, 3, device=scene.device)
        self._steps = torch.zeros(scene.num_envs, device=scene.device)
        self._forward = torch.zeros(scene.num_envs, 3, device=scene.device)
        self._forward[:, 2] = 1.0

    def act(self) -> None:
        """Set the velocity commands."""
        data = self.scene["endoscope"].data
        backs, begins = self._retreat.update(data.tip_arc_length)
        withdraws = self.speed < 0.0
        random = normalize(self.normal("side", 3))
        self._side = torch.where((begins & ~withdraws)[:, None], random, self._side)
        way = self._way.find()
        aim, gaze = self._seen(way, self.look), self._seen(way, self.gaze)
        pace = self.speed * (0.35 + 0.65 * gaze[:, 2].clamp(min=0.0))
        onward = self._rested(pace[:, None] * (self._direction(aim, gaze) + self.disturbance))
        away = self.speed.abs()[:, None] * (0.5 * self._side - data.tip_lumen_direction_w)
        velocity = torch.where((backs | withdraws)[:, None], quat_apply_inverse(data.tip_quat_w, away), onward)
        gaze = normalize(gaze + 0.5 * self.disturbance)
        turn = torch.linalg.cross(self._forward, gaze)
        turn = torch.where(gaze[:, 2:] < 0.0, normalize(turn), turn)
        turn = self.turn_gain[:, None] * turn
        turn = torch.where((withdraws & (self.sweep > 0.0))[:, None], self._circle(gaze), turn)
        self._steps += 1.0
        turn[:, 2] += self.roll * self._tether() * (2.0 * math.pi * CONTROL_STEP / self.roll_time * self._steps).sin()
        self.scene["endoscope"].set_tip_velocity_command(velocity, turn)

    def reset(self, env_ids: torch.Tensor) -> None:
        """Forget how far some worlds came."""
        self._retreat.reset(env_ids)
        self._steps[env_ids] = 0.0

    def memory(self) -> list[torch.Tensor]:
        """Return how far each world came, and to which side it backs off."""
        return [*self._retreat.memory, self._side, self._steps]

    def _seen(self, way: torch.Tensor, length: torch.Tensor) -> torch.Tensor:
        """Return the unit vector from the tip to a point of the way, in the tip's frame, shape (N, 3)."""
        data = self.scene["endoscope"].data
        return normalize(quat_apply_inverse(data.tip_quat_w, along(way, length) - data.tip_pos_w))

    def _rested(self, velocity: torch.Tensor) -> torch.Tensor:
        """Return velocities in the tip's frame, shape (N, 3), with those of tips that rest instead of pulling."""
        data = self.scene["endoscope"].data
        pull = quat_apply_inverse(data.tip_quat_w, data.tip_pull_force_w)[:, 2]
        eased = torch.nn.functional.pad(REST_SPEED * (REST_PULL - pull).clamp(-1.0, 1.0)[:, None], (2, 0))
        part = self._steps * CONTROL_STEP / REST_TIME
        rests = (part - part.floor() >= 1.0 - self.rest) & (self._tether() == 1.0)
        return torch.where(rests[:, None], eased, velocity) if self._has_tether else velocity

    def _tether(self) -> torch.Tensor:
        """Return how much of :data:`TETHERED` lies inside, at most all, shape (N,); all without a tether."""
        inside = (self.scene["endoscope"].data.inserted_length / TETHERED).clamp(0.0, 1.0)
        return inside if self._has_tether else torch.ones_like(inside)

    def _circle(self, gaze: torch.Tensor) -> torch.Tensor:
        """Return the angular velocity that leads the view around ``gaze`` at the angle of the sweep, shape (N, 3).

        A view at the angle ``a`` from ``gaze`` goes around it at ``rate * sin(a)``, without roll; the rest brings ``a``
        to that of the sweep. Both depend on where ``gaze`` is in the picture alone.
        """
        across = norm(gaze[:, :2])[:, None]
        angle = torch.atan2(across[:, 0], gaze[:, 2])
        beside = torch.where(
            across > 1.0e-6, gaze[:, :2] / across.clamp(min=1.0e-6), self._forward.new_tensor([1.0, 0.0])
        )
        towards = (self.turn_gain * (angle - self.sweep))[:, None] * torch.stack([-beside[:, 1], beside[:, 0]], dim=1)
        return torch.nn.functional.pad(SWEEP_RATE * gaze[:, :2] + towards, (0, 1))

    def _direction(self, aim: torch.Tensor, gaze: torch.Tensor) -> torch.Tensor:
        """Return the direction of the pull in the tip's frame: to the aim, along the axis, not into what it touches."""
        data = self.scene["endoscope"].data
        force = data.link_force_w[:, -1]
        off = quat_apply_inverse(data.tip_quat_w, force) / (norm(force)[:, None] + 0.3)
        against = (-2.0 * off[:, 2] - 0.2).clamp(0.0, 1.0)
        axis = self.axis * (1.0 - against) - self.back * against * (1.0 - gaze[:, 2]).clamp(0.0, 1.0)
        pull = normalize((1.0 - axis.abs())[:, None] * aim + axis[:, None] * self._forward)
        into = row_sum(pull * off).clamp(max=0.0)
        return pull + (self.slide * (0.2 - 0.8 * into))[:, None] * off
