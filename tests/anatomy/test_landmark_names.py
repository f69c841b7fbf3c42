# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Landmarks of a straight curve whose segments are 10 cm each."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.landmarks import BORDERS, LANDMARKS, find_landmarks

CURVE = Curve(np.linspace([0.0, 0.0, 0.0], [0.0, 0.0, 0.8], 50), 0.1 * np.arange(1, 9))


def test_borders_stand_between_segments() -> None:
    arcs = find_landmarks(CURVE)
    assert tuple(arcs) == LANDMARKS
    assert [arcs[name] for name in BORDERS] == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
    assert arcs["mid_transverse"] == pytest.approx(0.45)


def test_openings_are_sorted_in() -> None:
    arcs = list(find_landmarks(CURVE, {"appendix_orifice": 0.75}))
    assert arcs.index("cecum_entry") < arcs.index("appendix_orifice") < arcs.index("cecum_pole")
