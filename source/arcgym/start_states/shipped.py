# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Start states that lie beside colons: all of one robot in one tissue as one batch."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from arcgym import assets
from arcgym.assets.patient_files import find_stages
from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SimulationCfg, Snapshot, SnapshotSet
from arcgym.sim.snapshot_library import with_room
from arcgym.start_states import store
from arcgym.start_states.making import key_of
from arcgym.start_states.settling import left_alone, settle


@dataclass
class Shipped:
    """Start states of a robot in a tissue, one file a patient."""

    scene: InteractiveScene
    """A world for each state."""
    files: list[Path]
    """File of each patient."""
    sets: list[SnapshotSet]
    """Its states."""

    @property
    def keys(self) -> list[tuple[int, str]]:
        """Patient and name of each state."""
        return [(patient, name) for patient, states in enumerate(self.sets) for name in states.names]

    def colon(self, patient: int) -> str:
        """Return the name of a patient."""
        return self.scene.colon.patients[patient].name

    def left_alone(self, keys: Sequence[tuple[int, str]]) -> np.ndarray:
        """Return the forces in some states without commands, see :func:`arcgym.start_states.settling.left_alone`."""
        return left_alone(self.scene, self._states(keys))

    def settle(self, keys: Sequence[tuple[int, str]]) -> None:
        """Let some states settle, in place of those that are there."""
        for (patient, name), state in zip(keys, settle(self.scene, self._states(keys)), strict=True):
            one = self.sets[patient]
            snapshots = list(one.snapshots)
            snapshots[one.index(name)] = state
            self.sets[patient] = dataclasses.replace(one, snapshots=tuple(snapshots))

    def save(self, patient: int) -> None:
        """Replace a patient's file, which then says with which settings its states have settled."""
        about = {**self.sets[patient].about, "key": dataclasses.asdict(key_of(self.scene, patient))}
        dataclasses.replace(self.sets[patient], about=about).save(self.files[patient])

    def _states(self, keys: Sequence[tuple[int, str]]) -> list[tuple[int, Snapshot]]:
        return [(patient, self.sets[patient].snapshots[self.sets[patient].index(name)]) for patient, name in keys]


def load(robot: str, tissue: str, colons: Sequence[str], device: str) -> Shipped:
    """Return the states of a robot in a tissue that lie beside colons.

    Args:
        robot: ``capsule``, ``magnetic`` or ``proximal``.
        tissue: Tissue preset.
        colons: Colons, as ``ColonCfg.usd_path`` takes them.
        device: Device of the simulation.

    Raises:
        FileNotFoundError: If a colon has none.
        ValueError: If they do not fit.
    """
    endoscope, stages = getattr(assets, f"{robot.upper()}_CFG"), find_stages(list(colons))
    files = [store.beside_colon(stage, Path(endoscope.usd_path), tissue) for stage in stages]
    sets = [SnapshotSet.load(file) for file in files]
    colon = assets.ColonCfg(material=tissue, usd_path=[str(stage) for stage in stages], num_patients=None)
    worlds = len(stages) * max(len(states.names) for states in sets)
    cfg = InteractiveSceneCfg(num_envs=worlds, colon=colon, endoscope=endoscope)
    scene = InteractiveScene(cfg, SimulationCfg(device=device))
    for patient, states in enumerate(sets):
        states.check(scene.sim, patient)
    own = scene.sim.read_snapshot(0)
    fitted = [tuple(with_room(state, own) for state in states.snapshots) for states in sets]
    sets = [dataclasses.replace(states, snapshots=fit) for states, fit in zip(sets, fitted, strict=True)]
    return Shipped(scene, files, sets)
