# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Roll to and fro of a scope's drive, beside what is commanded. N worlds."""

from __future__ import annotations

import math

import torch

from arcgym.utils.worlds import fill_worlds

FULL_LENGTH = 0.6
"""Length of scope inside from which it rolls with the whole amplitude [m], as for the experts; a shorter one has little
friction to lose."""


class RollOscillation:
    """Roll rate ``amplitude * min(inserted / 0.6 m, 1) * sin(2 pi t / period)``, t since the world's reset.

    Friction lies along the path of the surface: a shaft that rolls faster than it slides has hardly any left along its
    way.
    """

    def __init__(self, amplitude: float, period: float, step_dt: float, num_envs: int, device: str):
        """Start all worlds at t = 0.

        Args:
            amplitude: Largest roll rate [rad/s].
            period: Time of one roll to and fro [s].
            step_dt: Control step [s].
            num_envs: Number of worlds N.
            device: Device of the tensors.
        """
        self._amplitude, self._phase_step = amplitude, 2.0 * math.pi * step_dt / period
        self._steps = torch.zeros(num_envs, device=device)
        self.rate = torch.zeros(num_envs, device=device)
        """Roll rate of the present control step [rad/s], shape (N,)."""

    def advance(self, inserted: torch.Tensor) -> None:
        """Begin a control step with the given lengths of scope inside [m], shape (N,)."""
        share = (inserted / FULL_LENGTH).clamp(0.0, 1.0)
        self.rate = self._amplitude * share * (self._phase_step * self._steps).sin()
        self._steps += 1.0

    def resume(self, step: int, env_ids: torch.Tensor | None = None) -> None:
        """Go on in the given worlds as after so many control steps."""
        fill_worlds(self._steps, env_ids, float(step))

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Set the given worlds back to t = 0."""
        fill_worlds(self._steps, env_ids, 0.0)
        fill_worlds(self.rate, env_ids, 0.0)
