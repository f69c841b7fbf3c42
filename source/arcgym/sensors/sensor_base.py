# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Interface of every sensor of the scene."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import torch

if TYPE_CHECKING:
    from arcgym.scene.interactive_scene import InteractiveScene
    from arcgym.sensors.sensor_base_cfg import SensorBaseCfg


class SensorBase(ABC):
    """A sensor of all worlds at once; it is made with its configuration and bound to the scene later."""

    def __init__(self, cfg: SensorBaseCfg) -> None:
        """Keep the configuration; nothing is allocated before :meth:`initialize`."""
        self.cfg = cfg
        self.time_since_update = 0.0
        """Simulated time since the last reading [s]."""

    @property
    @abstractmethod
    def data(self) -> Any:
        """Last readings of all worlds."""

    @abstractmethod
    def initialize(self, scene: InteractiveScene) -> None:
        """Bind the sensor to the scene's assets and allocates its buffers."""

    @abstractmethod
    def update(self, env_mask: torch.Tensor | None = None) -> None:
        """Take a new reading in the worlds of `env_mask`, shape (num_envs,), bool; None: in all."""

    @abstractmethod
    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget what earlier readings left behind in the worlds `env_ids`; None: in all."""

    def world_settings(self) -> dict[str, torch.Tensor]:
        """Return what differs between worlds and no reading changes, as views of shape (N, ...)."""
        return {}

    def memory(self) -> dict[str, torch.Tensor]:
        """Return the last readings and what the next ones depend on, as views of shape (N, ...)."""
        return {}

    def advance(self, dt: float) -> None:
        """Let `dt` seconds pass and takes a reading of all worlds when the update period is over."""
        self.time_since_update += dt
        if self.time_since_update >= self.cfg.update_period - 1.0e-9:
            self.time_since_update = 0.0
            self.update()
