# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Physics: model, solvers, contact, actuation, snapshots."""

import importlib
from typing import TYPE_CHECKING, Any

from arcgym.sim.simulation_cfg import ContactCfg, SimulationCfg, WallSolverCfg

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation
    from arcgym.sim.snapshot import Snapshot, SnapshotSet

_LAZY = {
    "Simulation": "arcgym.sim.simulation",
    "Snapshot": "arcgym.sim.snapshot",
    "SnapshotSet": "arcgym.sim.snapshot",
}

__all__ = ["ContactCfg", "Simulation", "SimulationCfg", "Snapshot", "SnapshotSet", "WallSolverCfg"]


def __getattr__(name: str) -> Any:
    """Import torch and Newton only when a runtime class is asked for."""
    if name in _LAZY:
        return getattr(importlib.import_module(_LAZY[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
