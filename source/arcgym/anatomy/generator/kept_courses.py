# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Courses of the five patients, kept as ``kept_courses.npz`` beside this file.

Version 2 of the generator relaxed them, with a result that depended on the processor by up to a millimeter. Kept, the
five patients can be made again anywhere; all others are relaxed anew.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

KEPT_COURSES = ("colon_1", "colon_2", "colon_3", "colon_4", "colon_5")
"""Names of the courses; colon 2 has one for each posture."""

_FILE = Path(__file__).with_suffix(".npz")


@cache
def kept_course(name: str, posture: str) -> tuple[np.ndarray, np.ndarray]:
    """Return points of a course [m], shape (n, 3), and arc lengths at the ends of its segments [m], shape (8,).

    Raises:
        ValueError: The course is not kept in this posture; lists those that are.
    """
    with np.load(_FILE) as kept:
        wanted = f"{name}_{posture}"
        if f"{wanted}_points" not in kept:
            known = sorted(key.removesuffix("_points") for key in kept if key.endswith("_points"))
            raise ValueError(
                f"ColonSpec.course = '{name}' is not kept for posture '{posture}'; kept are {', '.join(known)}. Take"
                " another posture, or leave course None to draw one."
            )
        return kept[f"{wanted}_points"], kept[f"{wanted}_ends"]
