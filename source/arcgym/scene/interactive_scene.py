# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The scene: assets, simulation and sensors of all worlds, by name."""

from __future__ import annotations

import dataclasses
from typing import Any

import torch

from arcgym.assets.colon import Colon
from arcgym.assets.endoscope import Endoscope
from arcgym.scene.interactive_scene_cfg import InteractiveSceneCfg
from arcgym.sensors import SensorBase
from arcgym.sim.patient_preparation import prepare_patients
from arcgym.sim.simulation import Simulation
from arcgym.sim.simulation_cfg import SimulationCfg
from arcgym.utils.class_type import construct
from arcgym.utils.progress import report
from arcgym.utils.string import did_you_mean


class InteractiveScene:
    """Builds and holds what is in the worlds; ``scene["colon"]``, ``scene["endoscope"]``, ``scene["camera"]``.

    All worlds lie at the same place: they share no contact, and positions keep their precision.
    """

    def __init__(self, cfg: InteractiveSceneCfg, sim_cfg: SimulationCfg):
        """Read the stages, build the simulation, then the sensors.

        Args:
            cfg: What is in the scene.
            sim_cfg: How it is simulated.

        Raises:
            StageError: If a stage cannot be used; before anything is allocated on the device.
        """
        self.cfg = cfg
        prepare_patients(cfg.colon)
        self.colon: Colon = construct(cfg.colon)
        self.endoscope: Endoscope = construct(cfg.endoscope)
        self.sensors: dict[str, SensorBase] = _build_sensors(cfg)
        report(f"building {cfg.num_envs} world{'s' * (cfg.num_envs != 1)}")
        self.sim = Simulation(sim_cfg, self.colon, self.endoscope, cfg.num_envs)
        self.env_origins = torch.zeros(cfg.num_envs, 3, device=self.device)
        for sensor in self.sensors.values():
            sensor.initialize(self)

    @property
    def num_envs(self) -> int:
        """Number of worlds N."""
        return self.cfg.num_envs

    @property
    def device(self) -> str:
        """Device of all tensors."""
        return self.sim.device

    def keys(self) -> list[str]:
        """Names of everything in the scene."""
        return ["colon", "endoscope", *self.sensors]

    def __getitem__(self, key: str) -> Any:
        """Asset or sensor by name.

        Raises:
            KeyError: If there is none of that name.
        """
        if key not in self.keys():
            raise KeyError(f"The scene has no {key!r}. {did_you_mean(key, self.keys())}")
        return self.sensors[key] if key in self.sensors else getattr(self, key)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Make the sensors forget the past of some worlds; states are reset by events."""
        for sensor in self.sensors.values():
            sensor.reset(env_ids)

    def update(self, dt: float, env_mask: torch.Tensor | None = None) -> None:
        """Let ``dt`` [s] pass for the sensors, or read again just the worlds in ``env_mask``, shape (N,), bool.

        With ``dt`` zero all worlds, or the masked ones, are read whatever the sensors' periods.
        """
        for sensor in self.sensors.values():
            if dt > 0.0:
                sensor.advance(dt)
            else:
                sensor.update(env_mask)


def _build_sensors(cfg: InteractiveSceneCfg) -> dict[str, SensorBase]:
    names = [f.name for f in dataclasses.fields(cfg) if f.name not in ("colon", "endoscope")]
    values = {name: getattr(cfg, name) for name in names}
    return {name: construct(value) for name, value in values.items() if hasattr(value, "class_type")}
