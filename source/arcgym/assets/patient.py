# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A patient: what the simulation, the camera and the tasks need of one colon's stage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.shell import ShellMesh, mid_surface, on_average, wall_thickness
from arcgym.anatomy.stage import (
    Centerline,
    ColonStage,
    ContactSurface,
    TissueMaterial,
    VisualMesh,
    WallMesh,
    read_colon,
)

THICKNESS_DIGITS = 6
"""Decimals to which the thickness of a stage's wall [m] counts: the rest is noise of single precision."""

Bounds = dict[str, tuple[float, float]]
"""Arc length at start and end [m] of each segment that a colon has."""


@dataclass(frozen=True, eq=False)
class Patient:
    """One colon. Its stage, with the fine surface, is read when it is first asked for."""

    path: Path
    """Stage file."""
    wall: WallMesh | ShellMesh
    """Simulated wall."""
    thickness: float
    """Thickness of the wall [m]."""
    material: TissueMaterial
    """Tissue that the stage asks for."""
    centerline: Centerline
    """Centerline at rest."""
    bounds: Bounds
    """Arc length at start and end of each segment [m]."""
    visual: VisualMesh
    """Surface that the policy's camera sees."""
    albedo_texture: Path
    """Color of the mucosa."""
    detail_texture: Path
    """Relief of the mucosa."""
    contact: ContactSurface | None = None
    """Fine surface that the scope may touch; None if the stage has none."""
    content: str = ""
    """Hash of the stage's files, empty if it was not asked for."""

    @property
    def name(self) -> str:
        """Name of the folder that the stage lies in, such as ``colon_1``."""
        return self.path.resolve().parent.name

    @cached_property
    def stage(self) -> ColonStage:
        """All of the stage."""
        return read_colon(self.path)


def read_patient(path: Path, thickness: float | None, shell: bool) -> Patient:
    """Read a stage.

    Args:
        path: Stage file.
        thickness: Thickness of the wall [m]; None takes the stage's.
        shell: Whether the wall is to be a shell, or the stage's tetrahedra.

    Raises:
        StageError: If the stage cannot be used.
    """
    return patient_of_stage(read_colon(path), path, thickness, shell)


def patient_of_stage(
    stage: ColonStage, path: Path = Path("colon.usda"), thickness: float | None = None, shell: bool = True
) -> Patient:
    """Return the patient of a stage in memory; arguments as of :func:`read_patient`."""
    if thickness is None:
        thickness = float(np.float32(round(wall_thickness(stage.wall), THICKNESS_DIGITS)))
    patient = Patient(
        path=path,
        wall=mid_surface(stage.wall, thickness) if shell else stage.wall,
        thickness=thickness,
        material=stage.material,
        centerline=stage.centerline,
        bounds=stage.segment_bounds(),
        visual=stage.visual_proxy,
        albedo_texture=stage.albedo_texture,
        detail_texture=stage.detail_texture,
        contact=stage.contact,
    )
    patient.__dict__["stage"] = stage
    return patient


def on_average_patient(patient: Patient) -> Patient:
    """Return a patient whose shell's faces lie on the colon's surface on average, see :func:`~.shell.on_average`."""
    assert isinstance(patient.wall, ShellMesh)  # as ColonCfg checks
    out = replace(patient, wall=on_average(patient.wall))
    if "stage" in patient.__dict__:
        out.__dict__["stage"] = patient.__dict__["stage"]
    return out


def span_table(patients: Sequence[Patient]) -> np.ndarray:
    """Return arc length at start and end [m] of each of ``SEGMENTS``, shape (P, S, 2), float32.

    A segment that a patient does not have begins and ends where the one before it ends.
    """
    table = np.zeros((len(patients), len(SEGMENTS), 2), np.float32)
    for row, patient in zip(table, patients, strict=True):
        end = 0.0
        for code, name in enumerate(SEGMENTS):
            row[code] = patient.bounds.get(name, (end, end))
            end = row[code, 1]
    return table
