# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Names of the places along a colon, and where they lie on a centerline whose segments are known."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from arcgym.anatomy.curve import Curve

BORDERS = (
    "rectosigmoid",
    "sigmoid_descending",
    "splenic_flexure_entry",
    "splenic_flexure_exit",
    "hepatic_flexure_entry",
    "hepatic_flexure_exit",
    "cecum_entry",
)
"""Landmarks between two segments, in the order in which a colonoscope meets them."""

LANDMARKS = ("anal_verge", *BORDERS[:4], "mid_transverse", *BORDERS[4:], "cecum_pole")
"""Landmarks of every colon, in order."""


def find_landmarks(curve: Curve, openings: dict[str, float] | None = None) -> dict[str, float]:
    """Return the arc length of each landmark [m], in order.

    Args:
        curve: Centerline with its segments.
        openings: Arc lengths of further landmarks [m], such as the openings of the cecum.
    """
    start = {name: curve.bounds(name)[0] for name in ("sigmoid", "descending", "splenic", "transverse")}
    hepatic, ascending, cecum = (curve.bounds(name)[0] for name in ("hepatic", "ascending", "cecum"))
    arcs = [0.0, start["sigmoid"], start["descending"], start["splenic"], start["transverse"]]
    arcs += [0.5 * (start["transverse"] + hepatic), hepatic, ascending, cecum, curve.length]
    landmarks = {**dict(zip(LANDMARKS, arcs, strict=True)), **(openings or {})}
    return dict(sorted(landmarks.items(), key=lambda item: item[1]))
