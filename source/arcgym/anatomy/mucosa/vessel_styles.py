# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Submucosal vessels of each stretch of the colon, and the band of the texture that shows it.

The rectum has a dense venous plexus (Thomson, Br J Surg 1975; Standring, Gray's Anatomy, ch. 66); the vasa recta of
the colon run round the wall from the mesenteric to the free border, long and sparsely branched on the right, shorter
and more tree-like towards the sigmoid (Ross, Br J Surg 1952). Counts and calibres are chosen by eye after endoscopic
pictures, as no one has published them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class VesselStyle:
    """Vessels of one stretch; counts are for a texture of 1024 x 2048 pixels that shows nothing else."""

    segments: tuple[str, ...]
    """Segments that look so, in order."""
    band: tuple[float, float]
    """Rows of the texture that show them, as shares of its height."""
    trunks: int
    """Number of large vessels."""
    trunk_width: float
    """Width of the widest [px]."""
    trunk_steps: int
    """Length of an unbranched large vessel [6 px]."""
    fine: int
    """Number of small vessel trees."""
    fine_width: float
    """Width of the widest of them [px]."""
    branching: float
    """Chance of a side branch at each step."""
    spread: float
    """Standard deviation of a trunk's direction from the circumferential one [rad]; above 2 it is random."""


STYLES = (
    VesselStyle(("rectum",), (0.0, 0.22), 110, 4.2, 22, 620, 2.6, 0.18, 3.0),
    VesselStyle(("sigmoid", "descending", "splenic"), (0.22, 0.50), 44, 5.2, 36, 170, 2.3, 0.13, 1.2),
    VesselStyle(("transverse", "hepatic"), (0.50, 0.75), 34, 5.6, 54, 115, 2.3, 0.08, 0.6),
    VesselStyle(("ascending", "cecum"), (0.75, 1.0), 34, 6.6, 84, 60, 2.4, 0.035, 0.22),
)
"""From the anus up; together the bands cover the texture."""


def texture_rows(s: np.ndarray, bounds: Mapping[str, tuple[float, float]], repeat: float) -> np.ndarray:
    """Return the texture coordinate v of arc lengths: each stretch walks to and fro over its band, and on to the next.

    Walking to and fro needs no seam; an odd number of passes, stretched or squeezed a little, ends at the next band.

    Args:
        s: Arc lengths [m].
        bounds: Arc length where each segment starts and ends [m].
        repeat: Length of colon that the whole texture covers [m].
    """
    v = np.zeros_like(s)
    for style in STYLES:
        start, end = bounds[style.segments[0]][0], bounds[style.segments[-1]][1]
        low, high = style.band
        passes = 2 * max(0, round(((end - start) / ((high - low) * repeat) - 1.0) / 2.0)) + 1
        share = passes * np.clip((s - start) / (end - start), 0.0, 1.0)
        walk = 1.0 - np.abs(1.0 - np.mod(share, 2.0))
        v = np.where(s >= start, low + (high - low) * walk, v)
    return v
