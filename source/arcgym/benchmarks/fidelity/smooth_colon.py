# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A shipped colon as a smooth surface through the vertices of its wall, and finer walls sampled from that."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.anatomy import ANCHOR_FIXED, ColonStage, WallMesh, write_colon
from arcgym.anatomy.meshing.wall import build_wall
from arcgym.benchmarks.fidelity.rod_surface import GridSurface
from arcgym.benchmarks.fidelity.tubes import grid_visual, hold, shipped_stage


@cache
def layer_surface(layer: int, until: float = math.inf, colon: str | None = None) -> GridSurface:
    """Return a smooth surface through one layer of the shipped wall's vertices.

    Args:
        layer: 0 for the lumen side, 1 for the outer one.
        until: Arc length of the last ring taken [m].
        colon: Stage of the colon; the default one if None.
    """
    wall = shipped_stage(colon).wall
    points = wall.points.reshape(2, len(wall.ring_arc), -1, 3)[layer].astype(float)
    return GridSurface(points[wall.ring_arc < until])


def smooth_stage(refine: int, until: float = math.inf, colon: str | None = None) -> ColonStage:
    """Return a shipped colon with a wall sampled from the smooth surfaces of its layers.

    The surface is the same for every ``refine``, which 1 samples at the shipped vertices. The generator's own surface
    is another one when it is sampled more finely: its folds are narrower than the shipped distance of rings.

    Args:
        refine: Rings and sectors for each one of the shipped wall.
        until: Arc length at which the wall ends, open [m]; to its blind end by default.
        colon: Stage of the colon; the default one if None.
    """
    shipped, inner = shipped_stage(colon), layer_surface(0, until, colon)
    arc = np.interp(inner.rows(refine), np.arange(len(shipped.wall.ring_arc)), shipped.wall.ring_arc)
    layers = np.stack([layer_surface(layer, until, colon).sample(refine) for layer in range(2)])
    wall = _wall(shipped.wall, layers, arc, refine, capped=math.isinf(until))
    visual = grid_visual(layers[0], arc)
    return replace(shipped, wall=wall, visual=visual, visual_proxy=visual, contact=None, **_cut(shipped, until))


def write_smooth(folder: Path, refine: int, until: float = math.inf, colon: str | None = None) -> Path:
    """Write :func:`smooth_stage` into a folder of its own within ``folder``, once, and return its path."""
    whose = f"_{Path(colon).parent.name}" if colon else ""
    path = folder / f"smooth_{refine}_{until:g}{whose}" / "colon.usda"
    return path if path.exists() else write_colon(smooth_stage(refine, until, colon), path)


def _wall(shipped: WallMesh, layers: np.ndarray, arc: np.ndarray, refine: int, capped: bool) -> WallMesh:
    """Return the wall, held over the lengths over which the shipped one is."""
    rings = len(shipped.ring_arc)
    codes = shipped.segment.reshape(2, rings, -1)[0, :, 0]
    moves = shipped.anchor.reshape(2, rings, -1)[0, :, 0] != ANCHOR_FIXED
    first, last = np.flatnonzero(moves)[[0, -1]]
    own = np.minimum(np.rint(np.arange(len(arc)) / refine).astype(int), rings - 1)
    wall = build_wall(layers, codes[own], arc, capped=capped)
    end = shipped.ring_arc[last + 1] if capped else arc[-1]
    return hold(wall, float(shipped.ring_arc[first - 1]), float(end))


def _cut(stage: ColonStage, until: float) -> dict[str, Any]:
    """Return centerline and landmarks up to an arc length [m]."""
    if math.isinf(until):
        return {}
    line = stage.centerline
    kept = line.arc < until
    parts = {name: getattr(line, name)[kept] for name in ("points", "arc", "radius", "segment")}
    end = float(parts["arc"][-1])
    return {"centerline": replace(line, **parts), "landmarks": {"anal_verge": 0.0, "blind_end": end}}
