# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Counts episodes that ended because a link was going through the wall, and those that no force explains."""

from __future__ import annotations

from typing import Any

import torch

from arcgym.assets.force_tiers import tiers_of


class Piercing:
    """Counts, on the device, the ends of episodes by ``wall_penetrated``. N worlds."""

    def __init__(self, env: Any) -> None:
        """Start at zero."""
        self._env = env
        self._limit = tiers_of(env.cfg).perforation
        self._force = torch.zeros(env.num_envs, device=env.device)
        self.clear()

    def clear(self) -> None:
        """Start to count anew."""
        self.ends = torch.zeros((), dtype=torch.long, device=self._env.device)
        """Ends so far."""
        self.light_ends = torch.zeros((), dtype=torch.long, device=self._env.device)
        """Those of them with less on the tip and on 50 mm of scope than perforates a colon."""

    def before_reset(self) -> None:
        """Take in the forces of a control step that a reset is about to clear."""
        data = self._env.scene["endoscope"].data
        force = torch.maximum(data.tip_force_peak, data.window_force_peak.amax(dim=1))
        self._force = torch.maximum(self._force, force)

    def look(self) -> torch.Tensor:
        """Count the ends of a control step, and return the worlds of those without such a force, bool, shape (N,)."""
        force, self._force = self._force, torch.zeros_like(self._force)
        terminations = self._env.termination_manager
        if "wall_penetrated" not in terminations.active_terms:
            return torch.zeros_like(force, dtype=torch.bool)
        pierced = terminations.get_term("wall_penetrated")
        light = pierced & (force < self._limit)
        self.ends += pierced.sum()
        self.light_ends += light.sum()
        return light
