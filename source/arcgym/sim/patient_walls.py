# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of the walls of all patients; those of several are kept in the cache folder."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton

from arcgym.assets.colon import Colon
from arcgym.assets.patient_cache import CODE, cached
from arcgym.sim.model_building import wall_modes, wall_parameters
from arcgym.sim.wall.ring_modes import RingModes
from arcgym.sim.wall.wall_parameters import WallParameters
from arcgym.utils.coerce import to_plain
from arcgym.utils.progress import report
from arcgym.utils.source_digest import source_digest

NOT_IN_WALL = ("class_type", "usd_path", "num_patients")
"""Fields of a colon's configuration that change no number of its wall, but for the stage itself."""
BUILDING_CODE = (*CODE, "arcgym.assets", "arcgym.sim.wall", "arcgym.sim.model_building")
"""Code that decides what the numbers are."""


@dataclass(frozen=True)
class PatientWall:
    """Wall of one patient."""

    parameters: WallParameters
    """Vertices and elements."""
    modes: RingModes
    """Ring modes."""


def patient_walls(colon: Colon) -> tuple[list[WallParameters], list[RingModes]]:
    """Return wall and ring modes of every patient."""
    indices = range(len(colon.patients))
    if len(indices) == 1:
        walls: Sequence[PatientWall] = [_build(colon, 0)]
    else:
        report(f"preparing {len(indices)} walls")
        with ThreadPoolExecutor() as pool:
            walls = list(pool.map(lambda index: _load(colon, index), indices))
    return [wall.parameters for wall in walls], [wall.modes for wall in walls]


def _load(colon: Colon, index: int) -> PatientWall:
    patient = colon.patients[index]
    if not patient.content or type(colon) is not Colon:
        return _build(colon, index)
    settings = {name: value for name, value in to_plain(colon.cfg).items() if name not in NOT_IN_WALL}
    key: list[Any] = [patient.content, patient.thickness, sorted(settings.items()), repr(colon.tissue)]
    key += [newton.__version__, source_digest(*BUILDING_CODE)]
    return cached("walls", key, patient.name, lambda: _build(colon, index))


def _build(colon: Colon, index: int) -> PatientWall:
    wall = wall_parameters(colon, index)
    return PatientWall(wall, wall_modes(wall))
