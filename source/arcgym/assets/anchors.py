# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Springs that hold the wall to its surroundings: peritoneum, or a mesentery with slack; in numpy.

A vertex at the distance d from its rest position is pulled back by k loose d within the slack s, and by
k (loose s + d - s) beyond: the colon swings almost freely until its mesentery is tight. Without slack the pull is k d.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.shell import ShellMesh
from arcgym.anatomy.stage import WallMesh
from arcgym.assets.materials import TissuePreset


@dataclass(frozen=True)
class AnchorSprings:
    """Spring of each wall vertex to its rest position, V vertices."""

    stiffness: np.ndarray
    """Stiffness k of the tight spring [N/m], shape (V,)."""
    loose: np.ndarray
    """Share of it that acts within the slack, 0..1, shape (V,)."""
    slack: np.ndarray
    """Distance s from the rest position at which the spring gets tight [m], shape (V,)."""

    @staticmethod
    def linear(stiffness: np.ndarray) -> AnchorSprings:
        """Springs without slack."""
        return AnchorSprings(stiffness, np.ones(len(stiffness)), np.zeros(len(stiffness)))


def anchor_springs(
    wall: WallMesh | ShellMesh, tissue: TissuePreset, stiffness: dict[str, float], slack: dict[str, float]
) -> AnchorSprings:
    """Springs of a wall: the outermost vertices of a ring carry its share in equal parts.

    Args:
        wall: The wall.
        tissue: Preset.
        stiffness: Stiffness per length of colon [N/m^2] of some segments, over the preset's.
        slack: Slack half way along some segments [m], over the preset's.
    """
    per_length = _by_segment({**tissue.anchor_stiffness, **stiffness})[wall.segment]
    largest = _by_segment({**tissue.anchor_slack, **slack})[wall.segment]
    outer = wall.layer == wall.layer.max()
    rings = len(wall.ring_arc)
    spacing = np.gradient(wall.ring_arc)[wall.ring]
    around = np.maximum(np.bincount(wall.ring[outer], minlength=rings)[wall.ring], 1)
    free = largest * np.sin(np.pi * way_along_segment(wall))
    loose = np.minimum(tissue.anchor_loose / np.maximum(per_length, 1.0e-9), 1.0)
    return AnchorSprings(
        stiffness=np.where(outer, per_length * spacing / around, 0.0),
        loose=np.where(free > 0.0, loose, 1.0),
        slack=np.maximum(free, 0.0),
    )


def _by_segment(values: dict[str, float]) -> np.ndarray:
    return np.array([values.get(name, 0.0) for name in SEGMENTS])


def way_along_segment(wall: WallMesh | ShellMesh) -> np.ndarray:
    """0 at the first ring of the vertex's segment, 1 at the last, shape (V,): a mesentery is highest in the middle."""
    arc, out = wall.ring_arc[wall.ring], np.zeros(len(wall.ring))
    for code in np.unique(wall.segment):
        own = wall.segment == code
        low, high = arc[own].min(), arc[own].max()
        out[own] = (arc[own] - low) / max(high - low, 1.0e-9)
    return out
