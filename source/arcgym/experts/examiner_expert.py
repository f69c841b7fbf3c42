# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Expert that pushes gently, and pulls back with a hooked tip and a turned shaft, as examiners are taught to."""

from __future__ import annotations

import math
from typing import ClassVar

import torch

from arcgym.experts.expert_base import CONTROL_STEP
from arcgym.experts.pull_back import PullBack
from arcgym.experts.push_expert import LARGEST_BENDING, PushExpert
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.utils.math import norm

HALF_TURN = math.pi
"""Largest turn of the shaft during a pull [rad]; it is turned back afterwards."""
HOOKING = 0.15
"""Bending by which the tip is hooked in a control step [rad]."""
UNWINDING = 0.1
"""Slowest rate at which the shaft is turned back [rad/s]."""


class ExaminerExpert(PushExpert):
    """Goes on slowly and stops pushing at a force; then it hooks the tip, turns the shaft clockwise and pulls back.

    It also pulls back where the tip does not get on, and where more scope goes in than it gets on. Its numbers are
    choices: textbooks name the moves, and no source was found that gives their speeds, lengths or forces.
    """

    VARIED: ClassVar[dict[str, tuple[float, float]]] = {
        "look": (0.015, 0.05),
        "gain": (0.1, 0.5),
        "largest": (1.5, LARGEST_BENDING),
        "least_pace": (0.15, 0.8),
        "patience": (100.0, 250.0),
        "slack": (0.08, 0.3),
        "slips": (0.02, 0.1),
        "hook": (0.0, LARGEST_BENDING),
        "wind": (0.0, 1.0),
        "pull": (0.1, 0.5),
    }
    FREEING: ClassVar[tuple[str, ...]] = ("hook", "wind", "pull")

    def __init__(
        self,
        scene: InteractiveScene,
        speed: float | torch.Tensor = 0.015,
        most_push: float = 10.0,
        hook: float = 2.0,
        wind: float = 0.5,
        pull: float = 0.4,
        slack: float = 0.15,
        slips: float = 0.04,
        patience: float = 150.0,
        **settings: float,
    ):
        """Keep the settings; each may be one number or one a world.

        Args:
            scene: The scene.
            speed: Insertion speed while the way is ahead, and that of a pull [m/s].
            most_push: Push or pull on the base that ends a push or a pull [N].
            hook: Bending that the tip is brought to while it is pulled back, in the direction that it has [rad].
            wind: Rate at which the shaft is turned clockwise meanwhile [rad/s], for half a turn at most.
            pull: Length of shaft that is pulled out at most [m].
            slack: See :class:`PushExpert`.
            slips: See :class:`PushExpert`.
            patience: See :class:`PushExpert`; long enough to put back in what was pulled out.
            settings: Further settings of :class:`PushExpert`.
        """
        super().__init__(scene, speed, slack=slack, slips=slips, patience=patience, **settings)
        self.most_push, self.hook, self.wind = self.each(most_push), self.each(hook), self.each(wind)
        self.pull = self.each(pull)
        self._wound = torch.zeros_like(self.velocity)
        self._pull_back = PullBack(self.most_push, self.slips, self.pull)
        self._pulling = torch.zeros_like(self.velocity, dtype=torch.bool)

    def act(self) -> None:
        """Set bending and insertion commands."""
        super().act()
        endoscope = self.scene["endoscope"]
        hard = (endoscope.data.base_force > self.most_push) & (self.velocity > 0.0)
        self.velocity = torch.where(hard, 0.0, self.velocity)
        self._hook_tip()
        endoscope.set_bending_command(self.bending[:, 0], self.bending[:, 1])
        endoscope.set_insertion_command(self.velocity, -self._wind_shaft())

    def reset(self, env_ids: torch.Tensor) -> None:
        """Take up the bending that some worlds start with, and stand still there."""
        super().reset(env_ids)
        self._pull_back.reset(env_ids)
        self._wound[env_ids] = 0.0
        self._pulling[env_ids] = False

    def merit(self) -> torch.Tensor:
        """Return the arc length of the tip less half of the scope that lies in loops [m], shape (N,)."""
        data = self.scene["endoscope"].data
        return data.tip_arc_length - 0.5 * (data.inserted_length - data.tip_arc_length)

    def memory(self) -> list[torch.Tensor]:
        """Return the commands of each world, and how far it came."""
        return [*super().memory(), *self._pull_back.memory, self._wound, self._pulling]

    def _pulls_back(self) -> tuple[torch.Tensor, torch.Tensor]:
        """Return which worlds are pulled back, and which begin to, both of shape (N,), bool."""
        data = self.scene["endoscope"].data
        begins = super()._pulls_back()[1]
        self._pulling, begins = self._pull_back.update(
            data.tip_arc_length, data.inserted_length, data.base_force, begins
        )
        return self._pulling, begins

    def _hook_tip(self) -> None:
        """Bend tips that are pulled back further the way that they are bent, up to the hook."""
        bent = norm(self.bending).clamp(min=1.0e-3)
        wanted = torch.maximum(bent, torch.minimum(self.hook, bent + HOOKING))
        self.bending = self.bending * torch.where(self._pulling, wanted / bent, 1.0)[:, None]

    def _wind_shaft(self) -> torch.Tensor:
        """Return the rate at which each shaft is turned clockwise [rad/s], shape (N,): in a pull, and back after it."""
        back = torch.where(self._wound > 0.0, -self.wind.clamp(min=UNWINDING), 0.0)
        rate = torch.where(self._pulling, torch.where(self._wound < HALF_TURN, self.wind, 0.0), back)
        self._wound = (self._wound + CONTROL_STEP * rate).clamp(min=0.0)
        return rate
