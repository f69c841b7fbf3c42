# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Ileocecal valve and appendix: where small bowel and a thin tube were cut off the cecum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from arcgym.anatomy.polyline import arc_lengths

VALVE, APPENDIX = "ileocecal_valve", "appendix_orifice"
"""Names of the landmarks, as in generated colons."""

_RIGHT = 0.150
"""Length of the colon's end in which the valve may lie [m]; it lies about 6 cm before the pole (Gray's Anatomy)."""

_BLIND = 0.090
"""Length of the end in which the appendix may leave [m]."""

_WIDEST_APPENDIX = 9.0
"""Largest diameter of an appendix [mm]; normal ones measure 3 to 10, collapsed ileum more."""

_NEAR = 0.060
"""Largest distance of an opening from the centerline [m]."""


@dataclass(frozen=True)
class CecalOpening:
    """An opening of the cecum."""

    position: np.ndarray
    """Where the lumen leaves the colon's [m], shape (3,)."""
    arc: float
    """Arc length of the centerline there [m]."""
    radius: float
    """Radius of its neck [m]."""


def cecal_openings(line: np.ndarray, cut: Sequence[dict[str, Any]], rotation: np.ndarray) -> dict[str, CecalOpening]:
    """Return the openings of the cecum that a scan shows, by name.

    Args:
        line: Centerline from the anal verge to the cecal pole in the patient's frame [m], shape (n, 3).
        cut: What was cut off, with places on the file's axes.
        rotation: From these to the patient's, shape (3, 3).
    """
    arc = arc_lengths(line)
    found: dict[str, CecalOpening] = {}
    for piece in sorted(cut, key=lambda piece: -piece["volume_ml"]):
        if "caliber_mm" not in piece or piece["kind"] not in ("small bowel", "side branch"):
            continue
        position = 1e-3 * rotation @ np.array(piece["place_mm"], float)
        distance = np.linalg.norm(line - position, axis=1)
        at = float(arc[distance.argmin()])
        name = APPENDIX if piece["caliber_mm"] <= _WIDEST_APPENDIX else VALVE
        reach = _BLIND if name == APPENDIX else _RIGHT
        if distance.min() < _NEAR and at > arc[-1] - reach and name not in found:
            found[name] = CecalOpening(position, at, 0.5e-3 * piece["neck_mm"])
    return found
