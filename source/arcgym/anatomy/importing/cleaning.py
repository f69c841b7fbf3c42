# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Keep the colon among the pieces of a mask: bridge gaps from end to end, drop everything else."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy import ndimage

from arcgym.anatomy.importing.bridging import Bridge, Piece, join_pieces, make_piece
from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.tubes import draw_tube
from arcgym.anatomy.voxel_grid import Grid

_SMALLEST_PIECE = 5e-7
"""Volume below which a piece is a speck and dropped [m^3]."""

_SMALLEST_COLON = 8e-5
"""Least volume of a colon's largest piece [m^3]; our choice."""

_LEAST_EXTENT = 0.15
"""Least extent of a colon along its longest axis [m]."""

_MOST_PIECES = 40
"""Number of pieces, the largest first, that may be joined; each takes a search."""

_BRIDGE_RADIUS = 0.008, 0.025
"""Least and largest radius of the tube that is drawn through a gap [m]; between, that of the lumen on either side."""

_OWN_END = 0.030
"""How far behind a tip the lumen is the bridged one, and no other loop, apart from its radius [m]."""


@dataclass
class Cleaning:
    """What was kept, joined, dropped and cut off."""

    pieces: int = 0
    """Separate pieces in the input."""
    specks: int = 0
    """Pieces below 0.5 ml, which are always dropped."""
    bridges: list[dict[str, Any]] = field(default_factory=list)
    """Gap and radius at both ends [mm], volume [ml] of the smaller piece, and place [mm] of each bridge."""
    dropped: list[dict[str, Any]] = field(default_factory=list)
    """Volume [ml] and place [mm] of the larger pieces that were left out."""
    cut: list[dict[str, Any]] = field(default_factory=list)
    """Kind, length, calibre and neck [mm], volume [ml] and place [mm] of what hung on the colon and was cut off."""
    pouches: list[dict[str, Any]] = field(default_factory=list)
    """Kind, length, calibre and neck [mm] and place [mm] of what sticks out of the colon and was left: haustra,
    or leaks as wide as they."""


def keep_colon(grid: Grid, max_gap: float) -> tuple[Grid, Cleaning]:
    """Keep the chain of pieces, joined end to end, that holds most.

    Args:
        grid: The lumen.
        max_gap: Longest collapsed or fluid-filled stretch to bridge [m].

    Returns:
        The field with other pieces set to 0 and bridges to 1, and what was done.

    Raises:
        ColonImportError: What is kept is no colon.
    """
    labels, count = ndimage.label(grid.mask, np.ones((3, 3, 3)))
    volume = np.bincount(labels.ravel(), minlength=count + 1)[1:] * grid.spacing**3
    if not count or volume.max() < _SMALLEST_COLON:
        largest = 1e6 * volume.max(initial=0.0)
        raise ColonImportError(
            f"No colon-like component: the largest of {count} pieces holds {largest:.1f} ml; a colon's lumen holds "
            f"more than {1e6 * _SMALLEST_COLON:.0f} ml",
            "Check --label and the units (--spacing, --units).",
        )
    order = [int(k) + 1 for k in np.argsort(-volume) if volume[k] > _SMALLEST_PIECE]
    done = Cleaning(pieces=count, specks=count - len(order))
    boxes = ndimage.find_objects(labels)
    single = len(order) == 1
    pieces = [make_piece(grid, labels, boxes[k - 1], k, float(volume[k - 1]), single) for k in order[:_MOST_PIECES]]
    kept, bridges = join_pieces(pieces, max_gap)
    _report_pieces(grid, done, pieces, kept, bridges)
    keep = np.isin(labels, [piece.label for piece in kept])
    _check_extent(keep, grid.spacing)
    return _drawn(grid, keep, bridges), done


def _report_pieces(grid: Grid, done: Cleaning, pieces: list[Piece], kept: list[Piece], bridges: list[Bridge]) -> None:
    for bridge in bridges:
        offset = bridge.end - bridge.start
        outside = float((grid.sample(bridge.start + np.linspace(0, 1, 200)[:, None] * offset) < 0.5).mean())
        figures = {
            "gap_mm": round(1e3 * outside * float(np.linalg.norm(offset)), 1),
            "radius_mm": [round(1e3 * float(value), 1) for value in np.clip(bridge.radius, *_BRIDGE_RADIUS)],
            "volume_ml": round(1e6 * bridge.volume, 1),
        }
        done.bridges.append(figures | {"place_mm": in_millimeters(0.5 * (bridge.start + bridge.end))})
    for piece in [piece for piece in pieces if piece not in kept][:20]:
        done.dropped.append({"volume_ml": round(1e6 * piece.volume, 1), "place_mm": in_millimeters(piece.middle)})


def in_millimeters(point: np.ndarray) -> list[int]:
    """Return a position in whole millimeters."""
    return [round(1e3 * float(value)) for value in point]


def _drawn(grid: Grid, keep: np.ndarray, bridges: list[Bridge]) -> Grid:
    """Return the field of what is kept, with bridges drawn and holes filled."""
    values = np.where(ndimage.binary_dilation(keep), grid.values, 0.0).astype(np.float32)
    values[keep] = np.maximum(values[keep], 0.51)
    out = Grid(values, grid.origin, grid.spacing)
    lumen = grid.points(np.argwhere(keep)) if bridges else np.zeros((0, 3))
    for bridge in bridges:
        _draw_bridge(out, bridge, lumen)
    inside = out.mask
    values[ndimage.binary_fill_holes(inside) & ~inside] = 1.0
    return out


def _check_extent(keep: np.ndarray, spacing: float) -> None:
    box = ndimage.find_objects(keep.astype(np.uint8))[0]
    extent = np.array([part.stop - part.start for part in box]) * spacing
    if extent.max() < _LEAST_EXTENT or extent.max() > 1.0:
        size = " x ".join(f"{1e3 * value:.0f}" for value in extent)
        raise ColonImportError(
            f"No colon-like component: what was kept measures {size} mm; a colon is 200 to 700 mm across",
            "Check the units (--spacing, --units), --label and --max-gap.",
        )


def _draw_bridge(grid: Grid, bridge: Bridge, lumen: np.ndarray) -> None:
    """Draw a tube as wide as the lumen on either side, a wall away from other loops, in place."""
    length = float(np.linalg.norm(bridge.end - bridge.start))
    share = np.linspace(0.0, 1.0, round(length / grid.spacing) + 2)
    first, last = np.clip(bridge.radius, *_BRIDGE_RADIUS)
    own = np.min([np.linalg.norm(lumen - tip, axis=1) for tip in (bridge.start, bridge.end)], axis=0)
    line = bridge.start + share[:, None] * (bridge.end - bridge.start)
    draw_tube(grid, line, first + share * (last - first), lumen[own > _OWN_END + max(first, last)])
