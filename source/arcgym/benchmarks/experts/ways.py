# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""States on the way of the foremost world, one file each, from which ``scripts/tools/film_way.py`` makes a film."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from arcgym.sim import Snapshot
from arcgym.start_states import Drive


class Ways:
    """Writes each state of a drive's trail, every 4 cm of the way, to ``<folder>/<arc length>.npz``."""

    def __init__(self) -> None:
        """Begin with no states."""
        self._last: dict[Path, float] = {}

    def keep(self, drive: Drive, patient: int, folder: Path) -> None:
        """Write the newest state of a patient's foremost world, unless it is there.

        Args:
            drive: The drive, with several worlds of each patient.
            patient: Which of its patients.
            folder: Folder of this patient's way.
        """
        places = drive.trail.places[patient]
        if not places or places[-1].arc <= self._last.get(folder, -1.0):
            return
        self._last[folder] = places[-1].arc
        folder.mkdir(parents=True, exist_ok=True)
        arrays = {name: array.cpu().numpy() for name, array in places[-1].state.items()}
        np.savez(folder / f"{places[-1].arc:.4f}.npz", **arrays)  # type: ignore[arg-type]


def read_way(folder: Path) -> dict[float, Snapshot]:
    """Return the states of a way by arc length [m], in its order."""
    states = {}
    for path in sorted(folder.glob("*.npz"), key=lambda path: float(path.stem)):
        with np.load(path) as data:
            states[float(path.stem)] = Snapshot({name: data[name] for name in data.files})
    return states
