# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Rules that keep actions on the side of the image where the lumen is.

They restate the "constrained PPO" of "ARCGym: Benchmarking Deep Reinforcement Learning in Autonomous Robotic
Colonoscopy" (RA-L 2026): a constant step forward, no roll, lateral and angular commands clamped towards the side of the
deep region of the depth image, and backing off from the wall. With simulator depth the policy is not one of color
images alone, so results belong beside those without the rules.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import torch

TIP_AXES: tuple[str, ...] = ("x", "y", "forward", "pitch", "yaw", "roll")
"""Raw actions of :class:`arcgym.envs.mdp.TipVelocityAction`."""

INSERTION_AXES: tuple[str, ...] = ("forward", "roll", "pitch", "yaw")
"""Raw actions of :class:`arcgym.envs.mdp.InsertionAction`."""


@dataclass(frozen=True)
class ConstraintRules:
    """Constants of the rules."""

    forward: float = 0.8
    """Raw action of the constant step forward, in [-1, 1]."""
    depth_threshold: float = 0.7
    """The deep region has at least this fraction of the largest depth."""
    far: float = 1.0
    """Depth is clipped here [m] first."""
    dead_zone: float = 0.0
    """Offset of the deep region, as a fraction of the half image, up to which no side is prescribed."""
    blocked_depth: float = 0.005
    """Nothing in view is farther than this [m] where the tip faces the wall, and backs off."""
    back_off_steps: int = 5
    """Control steps of backing off, without steering."""


def deep_region_offset(depth: torch.Tensor, threshold: float, far: float) -> torch.Tensor:
    """Return where the deep region is: right and down of the image center in half images, in [-1, 1], shape (N, 2).

    Args:
        depth: Distance along the ray [m], shape (N, H, W).
        threshold: Fraction of the largest depth from which on a pixel belongs to the region.
        far: Depth is clipped here [m] first.
    """
    clipped = depth.clamp(max=far)
    deep = (clipped >= threshold * clipped.amax(dim=(1, 2), keepdim=True)).float()
    pixels = deep.sum(dim=(1, 2)).clamp(min=1.0)
    height, width = depth.shape[1:]
    columns = torch.linspace(-1.0, 1.0, width, device=depth.device)
    rows = torch.linspace(-1.0, 1.0, height, device=depth.device)
    right = (deep.sum(dim=1) * columns).sum(dim=1) / pixels
    down = (deep.sum(dim=2) * rows).sum(dim=1) / pixels
    return torch.stack((right, down), dim=1)


class ActionConstraint:
    """The rules for N worlds; remembers which of them are backing off.

    The camera looks along the tip's +Z with image up along +Y, so that image right is the tip's -X. A lumen on the
    right asks for motion along -X and negative yaw (about Y), one below for motion along -Y and positive pitch
    (about X).
    """

    SIDES = {"x": (0, -1.0), "y": (1, -1.0), "pitch": (1, 1.0), "yaw": (0, -1.0)}
    """Image direction (0 right, 1 down) that prescribes an axis, and the sign of the action that goes there."""

    def __init__(self, axes: tuple[str, ...], depth: Callable[[], torch.Tensor], rules: ConstraintRules | None = None):
        """Make the rules.

        Args:
            axes: Name of each raw action, from ``x``, ``y``, ``forward``, ``pitch``, ``yaw``, ``roll``.
            depth: Gives the depth of the current view [m], shape (N, H, W).
            rules: Their constants.

        Raises:
            ValueError: If an axis is unknown.
        """
        unknown = [axis for axis in axes if axis not in TIP_AXES]
        if unknown:
            raise ValueError(f"Unknown action axis '{unknown[0]}', expected some of: {', '.join(TIP_AXES)}.")
        self.axes, self.rules = axes, rules or ConstraintRules()
        self._depth = depth
        self._backing = torch.zeros(0, dtype=torch.long)

    def __call__(self, actions: torch.Tensor) -> torch.Tensor:
        """Return the actions that the rules allow in the current view, shape (N, A)."""
        rules, depth = self.rules, self._depth().to(actions.device)
        offset = deep_region_offset(depth, rules.depth_threshold, rules.far)
        result = torch.stack([self._axis(i, axis, actions, offset) for i, axis in enumerate(self.axes)], dim=1)
        is_backing = self._watch_wall(depth)
        back = torch.tensor([-rules.forward if axis == "forward" else 0.0 for axis in self.axes], device=actions.device)
        return torch.where(is_backing[:, None], back, result)

    def reset(self, dones: torch.Tensor | None = None) -> None:
        """End the backing off of the worlds that are done, shape (N,), or of all."""
        if dones is None or len(self._backing) == 0:
            self._backing = torch.zeros(0, dtype=torch.long)
        else:
            self._backing = torch.where(dones.to(self._backing.device) > 0, 0, self._backing)

    def _axis(self, index: int, axis: str, actions: torch.Tensor, offset: torch.Tensor) -> torch.Tensor:
        """Return the allowed commands of one axis, shape (N,)."""
        action = actions[:, index]
        if axis == "forward":
            return torch.full_like(action, self.rules.forward)
        if axis == "roll":
            return torch.zeros_like(action)
        direction, sign = self.SIDES[axis]
        side = sign * offset[:, direction]
        free = side.abs() <= self.rules.dead_zone
        towards = torch.where(side > 0, action.clamp(min=0.0), action.clamp(max=0.0))
        return torch.where(free, action, towards)

    def _watch_wall(self, depth: torch.Tensor) -> torch.Tensor:
        """Worlds that back off in this step, bool, shape (N,)."""
        if len(self._backing) != len(depth):
            self._backing = torch.zeros(len(depth), dtype=torch.long, device=depth.device)
        blocked = (depth.amax(dim=(1, 2)) < self.rules.blocked_depth) & (self._backing == 0)
        self._backing = torch.where(blocked, self.rules.back_off_steps, self._backing)
        is_backing = self._backing > 0
        self._backing = (self._backing - 1).clamp(min=0)
        return is_backing


def action_axes(env: Any) -> tuple[str, ...]:
    """Return the axes of the raw actions of a manager-based environment.

    Raises:
        TypeError: If an action term is neither of the tip's velocity nor of insertion.
    """
    from arcgym.envs import mdp

    names: list[str] = []
    manager = env.unwrapped.action_manager
    for name in manager.active_terms:
        term = manager.get_term(name)
        if isinstance(term, mdp.TipVelocityAction):
            axes, fixed = TIP_AXES, term.cfg.forward_velocity is not None
        elif isinstance(term, mdp.InsertionAction):
            axes, fixed = INSERTION_AXES, term.cfg.insertion_velocity is not None
        else:
            raise TypeError(
                f"Action term '{name}' is a {type(term).__name__}, expected a TipVelocityAction or InsertionAction."
            )
        names += [axis for axis in axes if not (fixed and axis == "forward")]
    return tuple(names)
