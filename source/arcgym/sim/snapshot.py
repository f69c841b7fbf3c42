# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Complete states of one world, in memory and in a small file."""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from arcgym.sim.contact.loop_friction import LOOPS
from arcgym.sim.wall.abdomen import ABDOMEN
from arcgym.sim.wall.lumen_gas import GAS
from arcgym.sim.wall.tissue_shell import RELAXATION

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation


OPTIONAL = (GAS, RELAXATION, ABDOMEN, LOOPS)
"""Begin the names of arrays that stored states may lack or have too many; zeros stand for those that they lack."""
OPTIONAL_OF_DRIVES = (".play", ".lag")
"""End the names of such arrays."""


def optional(name: str) -> bool:
    """Whether a stored state may lack an array of this name, or have one that is not asked for."""
    return name.startswith(OPTIONAL) or name.endswith(OPTIONAL_OF_DRIVES)


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
        """Return the same place with all velocities zero."""
        still = {"joint_qd", "nodal_vel"}
        return Snapshot({name: np.zeros_like(a) if name in still else a for name, a in self.arrays.items()})

    def to_be_filled(self) -> Snapshot:
        """Return the same place without an amount of gas: a lumen that is filled when the state is written."""
        return Snapshot({name: array for name, array in self.arrays.items() if not name.startswith(GAS)})


@dataclass(frozen=True)
class SnapshotSet:
    """Named states of one colon and one endoscope."""

    names: tuple[str, ...]
    """Names in order, such as the segments whose starts they are."""
    snapshots: tuple[Snapshot, ...]
    """The states."""
    fingerprint: str
    """Identifies wall mesh and scope, see :func:`fingerprint`."""
    about: dict[str, Any] = field(default_factory=dict)
    """Notes of the file on the states: plain values, such as how far a drive came."""

    def index(self, name: str) -> int:
        """Place of a state in the set.

        Raises:
            KeyError: If there is none of that name.
        """
        if name not in self.names:
            raise KeyError(f"There is no snapshot {name!r}; this set has {list(self.names)}.")
        return self.names.index(name)

    def only(self, names: Sequence[str]) -> SnapshotSet:
        """Return the states of some names, in their order.

        Raises:
            KeyError: If there is none of a name.
        """
        return replace(self, names=tuple(names), snapshots=tuple(self.snapshots[self.index(name)] for name in names))

    def save(self, path: str | Path) -> None:
        """Write to an ``.npz`` file compressed by LZMA, a third smaller than by numpy itself, whole or not at all."""
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        stacked: dict[str, Any] = {k: np.stack([s.arrays[k] for s in self.snapshots]) for k in self.snapshots[0].arrays}
        partial = path.with_name(f".{path.stem}.{os.getpid()}.partial.npz")
        stacked |= {"names": self.names, "fingerprint": self.fingerprint, "about": json.dumps(self.about)}
        try:
            with zipfile.ZipFile(partial, "w", zipfile.ZIP_LZMA) as archive:
                for name, array in stacked.items():
                    with archive.open(f"{name}.npy", "w") as file:
                        np.lib.format.write_array(file, np.asanyarray(array), allow_pickle=False)
            os.replace(partial, path)
        finally:
            partial.unlink(missing_ok=True)

    @staticmethod
    def load(path: str | Path) -> SnapshotSet:
        """Read a file written by :meth:`save`.

        Raises:
            FileNotFoundError: If it is missing; names the command that makes it.
        """
        path = Path(path)
        if not path.is_file():
            raise FileNotFoundError(f"No start states at {path}. Make them with 'arcgym snapshots --task NAME'.")
        with np.load(path) as data:
            names = tuple(str(name) for name in data["names"])
            keys = [k for k in data.files if k not in ("names", "fingerprint", "about")]
            stacked = {k: data[k] for k in keys}
            mark = str(data["fingerprint"])
            about = json.loads(str(data["about"])) if "about" in data.files else {}
        states = tuple(Snapshot({k: stacked[k][i] for k in keys}) for i in range(len(names)))
        return SnapshotSet(names, states, mark, about)

    def check(self, sim: Simulation, patient: int = 0) -> None:
        """Compare with a patient of a simulation.

        Raises:
            ValueError: If the states are of another wall mesh or scope.
        """
        problem = self.mismatch(sim, patient)
        if problem:
            colon = sim.colon.patients[patient].path
            raise ValueError(
                f"These start states do not fit {colon} with {sim.endoscope.path}: {problem}. "
                "Make new ones with 'arcgym snapshots --task NAME'."
            )

    def mismatch(self, sim: Simulation, patient: int = 0) -> str:
        """Return what keeps the states from fitting a patient of a simulation; empty if they fit."""
        expected = fingerprint(sim, patient)
        if self.fingerprint != expected:
            return f"another wall mesh or endoscope (fingerprint {self.fingerprint}, expected {expected})"
        missing = set(sim.world_arrays()) ^ set(self.snapshots[0].arrays)
        missing = {name for name in missing if not optional(name)}
        return f"other actuators (differing in {', '.join(sorted(missing))})" if missing else ""


def fingerprint(sim: Simulation, patient: int = 0) -> str:
    """Return a short hash of a patient's rest points and rings and of the scope's links and joints."""
    wall, scope = sim.colon.patients[patient].wall, sim.endoscope.stage
    digest = hashlib.sha256(" ".join(sim.endoscope.joint_names).encode())
    for array in (wall.points, wall.ring, scope.link_length, scope.link_radius):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()[:16]
