# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What an import may be told."""

from __future__ import annotations

from dataclasses import dataclass, field

from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.importing.errors import ColonImportError

_RANGES = {
    "voxel": (0.0003, 0.01),
    "max_gap": (0.0, 0.15),
    "ring_spacing": (0.004, 0.03),
    "sectors": (6, 64),
    "wall_thickness": (0.0005, 0.006),
    "min_lumen_radius": (0.004, 0.03),
}
"""Smallest and largest value of settings in metres and of counts."""


@dataclass(frozen=True)
class ImportSettings:
    """Settings of an import; every default suits a CT colonography."""

    name: str = "imported"
    """Name of the colon."""
    label: int | tuple[int, ...] | None = None
    """Value of the colon in a label volume, or several, such as air's and fluid's; needed when there are several."""
    spacing: tuple[float, float, float] | None = None
    """Voxel spacing [mm] in place of the file's, or factors for a surface given in voxels."""
    units: str = "auto"
    """Unit of a surface: ``mm``, ``cm``, ``m``, or ``auto`` to tell by its size."""
    frame: str = "auto"
    """Axes of a surface, a key of :data:`arcgym.anatomy.importing.orientation.FRAMES`, or ``auto``."""
    anus: tuple[float, float, float] | None = None
    """Position of the anus [mm] on the patient's right, anterior and cranial axes, when it is not found."""
    cecum: tuple[float, float, float] | None = None
    """Position of the caecal pole [mm], likewise."""
    landmarks: dict[str, float | tuple[float, float, float]] = field(default_factory=dict)
    """Borders between segments that are known better than found: arc length [m], or a position [mm] as ``anus``."""
    posture: str = "supine"
    """How the patient lay, ``supine`` or ``prone``. The stage's axes are the patient's either way; the metadata say
    where gravity pulled in the scan."""
    licence: str = "unknown"
    """Licence of the data; kept in the metadata."""
    patient: str = "unknown"
    """Patient in words; kept in the metadata."""
    voxel: float = 0.001
    """Edge of the voxels that are worked on [m]. Smaller keeps finer folds and costs time and memory."""
    max_gap: float = 0.05
    """Longest collapsed or fluid-filled stretch to bridge [m]."""
    ring_spacing: float = ColonSpec.ring_spacing
    """Distance of the wall's rings [m], that of generated colons unless told otherwise."""
    sectors: int = ColonSpec.sectors
    """Wall vertices around a ring, likewise; more suit a wide colon: 12 are 13 mm apart where it is 50 mm wide."""
    wall_thickness: float = ColonSpec.wall_thickness
    """Thickness of the simulated wall [m], likewise."""
    min_lumen_radius: float = 0.008
    """Least distance from the centreline to the simulated wall [m]; lets a 13 mm scope through with 1.5 mm to spare."""
    clearance: float = 0.003
    """Least gap between the walls of two loops [m]."""
    visual_spacing: float = 0.0022
    """Distance of the cross-sections of the fine visual surface [m]."""
    visual_columns: int = 72
    """Points around the fine visual surface."""
    proxy_spacing: float = 0.004
    """Distance of the cross-sections of the surface drawn for policies [m]."""
    proxy_columns: int = 28
    """Points around the surface drawn for policies."""

    def __post_init__(self) -> None:
        """Checks the sizes.

        Raises:
            ColonImportError: Names the setting, its value and what is allowed.
        """
        for name, (low, high) in _RANGES.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise ColonImportError(f"{name} is {value:g}", f"Pass {low:g} to {high:g} (lengths in metres).")
