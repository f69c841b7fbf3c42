# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Physics: model, solvers, contact, actuation, snapshots."""

from typing import TYPE_CHECKING

from arcgym.sim.loop_friction_cfg import LoopFrictionCfg
from arcgym.sim.simulation_cfg import ContactCfg, SimulationCfg, WallSolverCfg
from arcgym.sim.weight_cfg import WeightCfg
from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation
    from arcgym.sim.snapshot import Snapshot, SnapshotSet

_LAZY = {
    "Simulation": "arcgym.sim.simulation",
    "Snapshot": "arcgym.sim.snapshot",
    "SnapshotSet": "arcgym.sim.snapshot",
}

__all__ = [
    "ContactCfg",
    "LoopFrictionCfg",
    "Simulation",
    "SimulationCfg",
    "Snapshot",
    "SnapshotSet",
    "WallSolverCfg",
    "WeightCfg",
]

__getattr__ = lazy_names(__name__, _LAZY)
