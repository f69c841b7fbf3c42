# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Import settings: facts about a scan, the grid of the wall, and the bounds of the lumen."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.grid_shape import GridShape
from arcgym.anatomy.importing.errors import ImportArgumentError
from arcgym.anatomy.importing.formats import FRAMES, GRAVITY, UNITS
from arcgym.anatomy.landmarks import BORDERS
from arcgym.utils.string import did_you_mean

_RANGES = {
    "voxel": (0.0003, 0.01),
    "max_gap": (0.0, 0.15),
    "rings": (8, 1000),
    "sectors": (6, 96),
    "wall_thickness": (0.0005, 0.006),
    "min_lumen_radius": (0.004, 0.03),
}
"""Smallest and largest value of settings in meters and of counts."""


_NAME = re.compile(r"\w[\w .-]{0,63}")
"""What a colon, and so its folder, may be called."""


@dataclass(frozen=True)
class ImportSettings:
    """Settings of an import; every default suits a CT colonography."""

    name: str = "imported"
    """Name of the colon: letters, digits, space, dot, minus and underscore."""
    label: int | tuple[int, ...] | None = None
    """Value of the colon in a label volume, or several, such as air's and fluid's; needed when there are several."""
    spacing: tuple[float, float, float] | None = None
    """Voxel spacing [mm] in place of the file's, or factors for a surface given in voxels."""
    units: str = "auto"
    """Unit of a surface: ``mm``, ``cm``, ``m``, or ``auto`` to tell by its size."""
    frame: str = "auto"
    """Axes of a surface, a key of :data:`arcgym.anatomy.importing.formats.FRAMES`, or ``auto``."""
    anus: tuple[float, float, float] | None = None
    """Position of the anus [mm] on the patient's right, anterior and cranial axes, when it is not found."""
    cecum: tuple[float, float, float] | None = None
    """Position of the cecal pole [mm], likewise."""
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
    rings: int = GridShape.rings
    """Rings of the wall. Colons of other numbers than generated ones have cannot be in one batch with them."""
    sectors: int = GridShape.sectors
    """Wall vertices around a ring, likewise."""
    wall_thickness: float = ColonSpec.wall_thickness
    """Thickness of the simulated wall [m], as in generated colons."""
    min_lumen_radius: float = 0.008
    """Least distance from the centerline to the simulated wall [m]; lets a 13 mm scope through with 1.5 mm to spare."""
    keep_doubtful: bool = False
    """Whether to make the folder although there are doubts about it, for looking at."""

    def __post_init__(self) -> None:
        """Check every setting.

        Raises:
            ImportArgumentError: Names the setting, its value and what is allowed.
        """
        for name, (low, high) in _RANGES.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise _out_of_range(name, value, low, high)
        _check_choice("units", self.units, ("auto", *UNITS))
        _check_choice("frame", self.frame, ("auto", *FRAMES))
        _check_choice("posture", self.posture, GRAVITY)
        if not _NAME.fullmatch(self.name):
            expected = "Pass letters, digits, space, dot, minus and underscore, a letter or digit first, 64 at most."
            raise ImportArgumentError(f"name is '{self.name}'", expected)
        if 0 in (self.label if isinstance(self.label, tuple) else (self.label,)):
            raise ImportArgumentError("label is 0, the background", "Pass the value of the colon.")
        if self.spacing is not None and not (_is_point(self.spacing) and min(self.spacing) > 0):
            raise ImportArgumentError(f"spacing is {self.spacing}", "Pass three numbers above 0.")
        for name in ("anus", "cecum"):
            if getattr(self, name) is not None and not _is_point(getattr(self, name)):
                raise ImportArgumentError(f"{name} is {getattr(self, name)}", "Pass X,Y,Z in millimeters.")
        self._check_landmarks()

    def _check_landmarks(self) -> None:
        for name, place in self.landmarks.items():
            if name not in BORDERS:
                raise ImportArgumentError(f"Unknown landmark '{name}'", did_you_mean(name, BORDERS))
            if isinstance(place, tuple) and _is_point(place):
                continue
            if isinstance(place, tuple) or not (math.isfinite(place) and place > 0.0):
                expected = "Pass an arc length from the anal verge [m], above 0, or a position X,Y,Z [mm]."
                raise ImportArgumentError(f"Landmark '{name}' is at {place}", expected)


def _out_of_range(name: str, value: float, low: float, high: float) -> ImportArgumentError:
    """Return the error of a count, or of a length in the units of code [m] and command [mm]."""
    if isinstance(low, int):
        return ImportArgumentError(f"{name} is {value:g}", f"Pass {low} to {high}.")
    expected = f"Pass {low:g} to {high:g} m ({1e3 * low:g} to {1e3 * high:g} mm in commands)."
    return ImportArgumentError(f"{name} is {value:g} m ({1e3 * value:g} mm)", expected)


def _check_choice(name: str, value: str, known: Iterable[str]) -> None:
    if value not in known:
        raise ImportArgumentError(f"{name} is '{value}'", f"Pass one of {', '.join(known)}.")


def _is_point(values: tuple[float, ...]) -> bool:
    return len(values) == 3 and all(math.isfinite(value) for value in values)
