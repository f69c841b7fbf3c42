# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A tube that folds: a bend of 15 mm radius by 130 degrees under a lumen of 16 mm radius, with semilunar folds."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy.polyline import arc_lengths

STEP = 0.0005


def centerline(bend: float = 0.015, leg: float = 0.06, turn: float = 130.0) -> np.ndarray:
    """Straight, a bend of constant radius, straight, in the plane z = 0; points 0.5 mm apart."""
    way = np.arange(0, 2 * leg + bend * np.radians(turn), STEP)
    angle = np.clip((way - leg) / bend, 0, np.radians(turn))
    return np.cumsum(STEP * np.stack([np.sin(angle), np.cos(angle), 0 * angle], 1), 0)


def field(
    line: np.ndarray, radius: float = 0.016, fold: float = 0.005, spacing: float = 0.00125
) -> tuple[np.ndarray, np.ndarray]:
    """Radius less distance to the line, with folds every 25 mm; values and the first voxel's position."""
    s, low = arc_lengths(line), line.min(0) - radius - 0.006
    count = np.ceil((line.max(0) + radius + 0.006 - low) / spacing).astype(int)
    at = low + spacing * np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), -1).reshape(-1, 3)
    distance, near = cKDTree(line).query(at)
    height = np.zeros(len(at))
    for k, crest in enumerate(np.arange(0.025, s[-1] - 0.025, 0.025)):
        side = np.cos(np.arctan2(at[:, 2], (at[:, 0] - line[near, 0])) - 2.1 * k)
        profile = np.exp(-(((s[near] - crest) / 0.0025) ** 2))
        height = np.maximum(height, profile * np.clip(0.35 + side, 0, 1))
    return (radius - distance - fold * height).reshape(count), low
