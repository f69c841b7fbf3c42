# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Checks that patients can share a batch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from arcgym.assets.patient import Patient

SHARED = ("triangles", "tets", "ring", "layer", "frame_neighbors")
"""What the walls of all patients of a run have in common, as far as they have it."""
SAME_THICKNESS = 1.0e-4
"""Relative difference below which stages are equally thick: single precision."""


def check_patients(patients: Sequence[Patient], from_stage: Sequence[str]) -> None:
    """Check that patients have one grid, one thickness and one tissue.

    Args:
        patients: The patients.
        from_stage: Fields of the tissue that are taken from the stages.

    Raises:
        ValueError: If one differs from the first; names its stage, what it has and what the first has.
    """
    first = patients[0]
    for patient in patients[1:]:
        _check_grid(patient, first)
        _check_value(patient, first, "thickness", patient.thickness, first.thickness, "wall_thickness", " m")
        for name in from_stage:
            values = getattr(patient.material, name), getattr(first.material, name)
            _check_value(patient, first, name, *values, name, "")


def _check_grid(patient: Patient, first: Patient) -> None:
    own, theirs = patient.wall, first.wall
    same = type(own) is type(theirs) and len(own.ring_arc) == len(theirs.ring_arc)
    differ = [name for name in SHARED if not _equal(getattr(own, name, None), getattr(theirs, name, None))]
    if not same or differ:
        raise ValueError(
            f"{patient.path} has a wall of {_grid(own)}, {first.path} one of {_grid(theirs)} (they differ in "
            f"{', '.join(differ) or 'kind'}): all patients of a run need the same grid. Leave it out, or make both "
            "with the same numbers of rings and sectors and the same version of ARCGym."
        )


def _equal(one: np.ndarray | None, other: np.ndarray | None) -> bool:
    return one is other or (one is not None and other is not None and np.array_equal(one, other))


def _grid(wall: Any) -> str:
    rings = len(wall.ring_arc)
    return f"{rings} rings and {len(wall.points)} vertices"


def _check_value(
    patient: Patient, first: Patient, name: str, value: float, expected: float, field: str, unit: str
) -> None:
    if not np.isclose(value, expected, rtol=SAME_THICKNESS, atol=0.0):
        what = f"a {name.replace('_', ' ')} of"
        raise ValueError(
            f"{patient.path} has {what} {value:g}{unit}, {first.path} {what} {expected:g}{unit}, "
            f"but all patients of a run share one: set env.scene.colon.{field}."
        )
