# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Actions that no learner would take on purpose. N worlds, A raw actions."""

from __future__ import annotations

import math

import torch

KINDS = ("random", "bang_bang", "limits", "overdrive", "reverse", "push", "sinusoid", "seek_force")
"""Kinds of actions; world i gets kind i modulo their number.

- random: uniform in [-1, 1];
- bang_bang: every axis at a limit, all drawn anew with a chance of 30 % a step;
- limits: every axis at a limit for 5 s;
- overdrive: bang_bang a hundred times over the limits, where raw actions are to be clipped;
- reverse: full speed forwards and back, turned round every 1 to 20 steps, the other axes at a limit;
- push: full speed forwards for 5 s, the other axes at a limit, which turns the tip into the wall;
- sinusoid: every axis on a frequency of its own, up to half the control rate, drawn anew every 5 s;
- seek_force: pushes on as long as the largest force on a window rises, and tries other limits when it falls.
"""
HOLD_S = 5.0
"""Time for which a world keeps its limits, frequencies and period [s]."""
SWITCH = 0.3
"""Chance a step that bang_bang draws its limits anew."""
OVERDRIVE = 100.0
"""Raw actions of overdrive, in units of the limits."""
LONGEST_PERIOD = 20
"""Most control steps between two reversals."""
SLOWEST_HZ = 0.05
"""Lowest frequency of a sinusoid [Hz]."""


class Adversaries:
    """Draws the actions of all worlds, on the device."""

    def __init__(self, num_envs: int, num_actions: int, forward: int, step_dt: float, device: str, seed: int) -> None:
        """Seed a generator that the environment does not share.

        Args:
            num_envs: Worlds, N.
            num_actions: Raw actions, A.
            forward: Axis that drives the scope forwards.
            step_dt: Control step [s].
            device: Device of the actions.
            seed: Seed of the actions.
        """
        self.kind = torch.arange(num_envs, device=device) % len(KINDS)
        self._shape, self._forward, self._step_dt, self._device = (num_envs, num_actions), forward, step_dt, device
        self._hold = max(1, round(HOLD_S / step_dt))
        self._generator = torch.Generator(device=device).manual_seed(seed)
        self._age = torch.randint(0, self._hold, (num_envs,), generator=self._generator, device=device)
        self._force = torch.zeros(num_envs, device=device)
        self._switching, self._held = self._limits(), self._limits()
        self._frequency, self._phase, self._period = self._frequencies(), self._uniform(), self._periods()

    def act(self, force: torch.Tensor, restarted: torch.Tensor) -> torch.Tensor:
        """Return the next actions, shape (N, A).

        Args:
            force: Largest force on a link of each world [N], shape (N,).
            restarted: Worlds that were reset in the last step, bool, shape (N,).
        """
        self._age += 1
        old = (self._age >= self._hold) | restarted
        self._age[old] = 0
        falling = (force < self._force) & (self.kind == KINDS.index("seek_force"))
        self._force = force.clone()
        self._renew(old, old | falling)
        every_kind = self._of_every_kind()
        stacked = torch.stack([every_kind[name] for name in KINDS])
        return stacked.gather(0, self.kind[None, :, None].expand(1, *self._shape))[0]

    def _of_every_kind(self) -> dict[str, torch.Tensor]:
        time = self._age[:, None] * self._step_dt
        turns = (self._age // self._period) % 2
        return {
            "random": 2.0 * self._uniform() - 1.0,
            "bang_bang": self._switching,
            "limits": self._held,
            "overdrive": OVERDRIVE * self._switching,
            "reverse": self._driven(1.0 - 2.0 * turns),
            "push": self._driven(1.0),
            "sinusoid": torch.sin(2.0 * math.pi * (self._frequency * time + self._phase)),
            "seek_force": self._driven(1.0),
        }

    def _driven(self, speed: torch.Tensor | float) -> torch.Tensor:
        """Return the limits held, with another speed forwards."""
        actions = self._held.clone()
        actions[:, self._forward] = speed
        return actions

    def _renew(self, old: torch.Tensor, limits: torch.Tensor) -> None:
        """Draw waves and periods of ``old`` worlds and the limits held of some, both bool, shape (N,)."""
        switch = torch.rand(self._shape[0], generator=self._generator, device=self._device) < SWITCH
        self._switching = torch.where(switch[:, None], self._limits(), self._switching)
        self._held = torch.where(limits[:, None], self._limits(), self._held)
        self._frequency = torch.where(old[:, None], self._frequencies(), self._frequency)
        self._phase = torch.where(old[:, None], self._uniform(), self._phase)
        self._period = torch.where(old, self._periods(), self._period)

    def _uniform(self) -> torch.Tensor:
        return torch.rand(self._shape, generator=self._generator, device=self._device)

    def _limits(self) -> torch.Tensor:
        return torch.where(self._uniform() < 0.5, -1.0, 1.0)

    def _frequencies(self) -> torch.Tensor:
        """Return frequencies, log-uniform up to half the control rate [Hz], shape (N, A)."""
        fastest = 0.5 / self._step_dt
        return SLOWEST_HZ * (fastest / SLOWEST_HZ) ** self._uniform()

    def _periods(self) -> torch.Tensor:
        return torch.randint(1, LONGEST_PERIOD + 1, self._shape[:1], generator=self._generator, device=self._device)
