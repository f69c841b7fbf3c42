# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Named places along the colon."""

from __future__ import annotations

from arcgym.anatomy.curve import Curve

LANDMARKS = (
    "anal_verge",
    "rectosigmoid",
    "sigmoid_descending",
    "splenic_flexure_entry",
    "splenic_flexure_exit",
    "mid_transverse",
    "hepatic_flexure_entry",
    "hepatic_flexure_exit",
    "cecum_entry",
    "cecum_pole",
)
"""Landmarks in the order in which a colonoscope meets them."""


def find_landmarks(curve: Curve, openings: dict[str, float] | None = None) -> dict[str, float]:
    """Returns the arc length of each landmark [m], in order; ``openings`` are those of the caecum."""
    start = {name: curve.bounds(name)[0] for name in ("sigmoid", "descending", "splenic", "transverse")}
    hepatic, ascending, cecum = (curve.bounds(name)[0] for name in ("hepatic", "ascending", "cecum"))
    arcs = [0.0, start["sigmoid"], start["descending"], start["splenic"], start["transverse"]]
    arcs += [0.5 * (start["transverse"] + hepatic), hepatic, ascending, cecum, curve.length]
    landmarks = {**dict(zip(LANDMARKS, arcs, strict=True)), **(openings or {})}
    return dict(sorted(landmarks.items(), key=lambda item: item[1]))
