# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How far the borders of the segments may be off: how they move when what their rules rest on is varied."""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.spatial.transform import Rotation

from arcgym.anatomy.importing.segment_borders import CECUM, ILIAC_FOSSA, RECTUM, borders_of_course
from arcgym.anatomy.landmarks import BORDERS

_TILT = np.radians(10.0)
"""How far a patient may lie askew in the scanner [rad]; our choice. Two humps of a flexure change places by that."""

_FOSSA = 0.020
"""How much higher or lower the iliac fossa may be [m]: 1.3 times the standard deviation of sitting height, 3 cm, times
the fossa's share of it, a half; our choice."""

_RECTUM = 0.015
"""Half the range of what is called the end of the rectum [m]: 12 to 15 cm above the verge, and the sigmoid take-off."""

_CECUM = 0.015
"""Half the range of the cecum's length [m]; our choice."""


def border_uncertainty(points: np.ndarray, arc: np.ndarray, given: dict[str, float]) -> dict[str, float]:
    """Return half the range of each border [m] when the patient is tilted and the iliac fossa lies higher or lower.

    Args:
        points: Centerline from the anal verge, +X right, +Y anterior, +Z cranial [m], shape (n, 3).
        arc: Its arc length [m], shape (n,).
        given: Landmarks that the caller knows; they are certain.
    """
    found: dict[str, list[float]] = {name: [] for name in BORDERS}
    for (pitch, roll), higher in product(((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)), (-1, 0, 1)):
        turn = Rotation.from_euler("xy", [_TILT * pitch, _TILT * roll])
        for name, value in borders_of_course(turn.apply(points), arc, ILIAC_FOSSA + _FOSSA * higher).items():
            found[name].append(value)
    half = {name: 0.5 * float(np.ptp(values)) for name, values in found.items()}
    half["rectosigmoid"] = max(half["rectosigmoid"], _RECTUM * min(1.0, 0.2 * float(arc[-1]) / RECTUM))
    half["cecum_entry"] = max(half["cecum_entry"], _CECUM * min(1.0, 0.06 * float(arc[-1]) / CECUM))
    return half | dict.fromkeys(given, 0.0)
