# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Complete states of one world, in memory and in a small file beside the colon's stage."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from arcgym.assets import Colon, Endoscope
    from arcgym.sim.simulation import Simulation

DEFAULT_MATERIAL = "paper"
"""Tissue preset that snapshots are made in unless their file names another one."""


@dataclass(frozen=True)
class Snapshot:
    """State of one world: the arrays of :meth:`Simulation.world_arrays` by name, without the world dimension."""

    arrays: dict[str, np.ndarray]
    """Positions, velocities, targets and what the drives remember."""

    @staticmethod
    def read(sim: Simulation, env_id: int) -> Snapshot:
        """Copy the state of one world to the host."""
        return Snapshot({name: array[env_id].cpu().numpy().copy() for name, array in sim.world_arrays().items()})

    def at_rest(self) -> Snapshot:
        """The same place with all velocities zero."""
        still = {"joint_qd", "nodal_vel"}
        return Snapshot({name: np.zeros_like(a) if name in still else a for name, a in self.arrays.items()})


@dataclass(frozen=True)
class SnapshotSet:
    """Named states of one colon and one endoscope."""

    names: tuple[str, ...]
    """Names in order, such as the segments whose starts they are."""
    snapshots: tuple[Snapshot, ...]
    """The states."""
    fingerprint: str
    """Identifies wall mesh and scope, see :func:`fingerprint`."""

    def index(self, name: str) -> int:
        """Place of a state in the set.

        Raises:
            KeyError: If there is none of that name.
        """
        if name not in self.names:
            raise KeyError(f"There is no snapshot {name!r}; this set has {list(self.names)}.")
        return self.names.index(name)

    def save(self, path: str | Path) -> None:
        """Write to a compressed ``.npz`` file, whole or not at all."""
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        stacked: dict[str, Any] = {k: np.stack([s.arrays[k] for s in self.snapshots]) for k in self.snapshots[0].arrays}
        partial = path.with_suffix(".partial.npz")
        np.savez_compressed(partial, names=np.array(self.names), fingerprint=np.array(self.fingerprint), **stacked)
        os.replace(partial, path)

    @staticmethod
    def load(path: str | Path) -> SnapshotSet:
        """Read a file written by :meth:`save`.

        Raises:
            FileNotFoundError: If it is missing; names the command that makes it.
        """
        path = Path(path)
        if not path.is_file():
            raise FileNotFoundError(f"No snapshots at {path}. Make them with scripts/tools/make_snapshots.py.")
        with np.load(path) as data:
            names = tuple(str(name) for name in data["names"])
            keys = [k for k in data.files if k not in ("names", "fingerprint")]
            stacked = {k: data[k] for k in keys}
            mark = str(data["fingerprint"])
        return SnapshotSet(names, tuple(Snapshot({k: stacked[k][i] for k in keys}) for i in range(len(names))), mark)

    def check(self, sim: Simulation) -> None:
        """Compare with a simulation.

        Raises:
            ValueError: If the states are of another wall mesh or scope.
        """
        expected = fingerprint(sim)
        if self.fingerprint != expected:
            raise ValueError(
                f"The snapshots are of another wall mesh or endoscope than {sim.colon.path} with {sim.endoscope.path} "
                f"(fingerprint {self.fingerprint}, expected {expected}). "
                f"Make them with scripts/tools/make_snapshots.py --colon {sim.colon.path} "
                f"--material {sim.colon.cfg.material} --endoscope {sim.endoscope.path.stem}."
            )


def fingerprint(sim: Simulation) -> str:
    """Short hash of what a state depends on: the wall's rest points and rings, the scope's links and joints."""
    wall, scope = sim.colon.wall, sim.endoscope.stage
    digest = hashlib.sha256(" ".join(sim.endoscope.joint_names).encode())
    for array in (wall.points, wall.ring, scope.link_length, scope.link_radius):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()[:16]


def snapshot_path(colon_path: Path, endoscope_path: Path, material: str = DEFAULT_MATERIAL) -> Path:
    """Where the snapshots of a colon and an endoscope lie, beside the colon's stage.

    ``snapshots/<endoscope>.npz``, or ``snapshots/<endoscope>_<material>.npz`` in another tissue than the default.
    """
    suffix = "" if material == DEFAULT_MATERIAL else f"_{material}"
    return colon_path.parent / "snapshots" / f"{endoscope_path.stem}{suffix}.npz"


def find_snapshots(colon: Colon, endoscope: Endoscope) -> Path:
    """Path of the snapshots made in the colon's tissue, else of those made in the default one, which may not fit."""
    own = snapshot_path(colon.path, endoscope.path, colon.cfg.material)
    return own if own.is_file() else snapshot_path(colon.path, endoscope.path)
