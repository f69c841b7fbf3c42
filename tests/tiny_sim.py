# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A tiny simulation for tests: a scope of a few links in a short tube of colon."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import warp as wp
from tiny import write_tiny_colon
from tiny_scope import write_tiny_scope

from arcgym.assets import CAPSULE_CFG, MAGNETIC_CFG, PROXIMAL_CFG, ColonCfg, EndoscopeCfg
from arcgym.assets.colon import Colon
from arcgym.assets.endoscope import Endoscope
from arcgym.sim import Simulation, SimulationCfg

SCOPES = {"capsule": CAPSULE_CFG, "magnetic": MAGNETIC_CFG, "proximal": PROXIMAL_CFG}


def steps(sim: Simulation, seconds: float) -> int:
    """Physics steps in ``seconds``, however long one is."""
    return round(seconds / sim.physics_dt)


def own_patients(count: int, device: str) -> wp.array:
    """Return the index of patients for one world each, 0 to ``count`` - 1, shape (count,), int32."""
    return wp.array(np.arange(count, dtype=np.int32), dtype=int, device=device)


class TinySim:
    """Writes the stages once into a folder and builds simulations with them."""

    def __init__(self, folder: Path, **tube: Any) -> None:
        """``tube`` shapes the colon, see :func:`tiny.tiny_colon_stage`."""
        self.folder = folder
        self.colon_path = write_tiny_colon(folder, **tube)

    def colon_cfg(self, **changes: Any) -> ColonCfg:
        return ColonCfg(**{"usd_path": str(self.colon_path), **changes})

    def scope_cfg(
        self, kind: str = "proximal", links: int = 6, drives: dict[str, dict[str, Any]] | None = None, **changes: Any
    ) -> EndoscopeCfg:
        """``drives`` changes actuators by name, ``changes`` the rest."""
        path = self.folder / f"{kind}_{links}.usda"
        if not path.exists():
            write_tiny_scope(path, kind, links)
        cfg = replace(SCOPES[kind].copy(), usd_path=str(path), **changes)
        for name, values in (drives or {}).items():
            cfg.actuators[name] = cfg.actuators[name].replace(**values)
        return cfg

    def __call__(
        self,
        kind: str = "proximal",
        links: int = 6,
        num_envs: int = 1,
        colon: dict[str, Any] | None = None,
        scope: dict[str, Any] | None = None,
        **cfg: Any,
    ) -> Simulation:
        """Builds a simulation; ``colon``, ``scope`` and ``cfg`` change the three configurations."""
        assets = Colon(self.colon_cfg(**colon or {})), Endoscope(self.scope_cfg(kind, links, **scope or {}))
        return Simulation(SimulationCfg(**cfg), *assets, num_envs)
