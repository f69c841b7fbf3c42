# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Spacing of the visual surface's cross-sections: along the crests of the folds, and closer together there."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.generator.folds import nearness, valve_height
from arcgym.anatomy.generator.surface import Surface

_BETWEEN_FOLDS = 0.30
"""Density of rows between folds; on a crest it is 1 more."""

_NEAR = 0.0012
"""How far beside a crest rows are denser [m]."""

_EVEN_OUT = 0.030
"""Length over which columns keep level with each other [m]."""


def row_positions(surface: Surface, theta: np.ndarray, start: float, end: float, rows: int) -> np.ndarray:
    """Return the arc length of each cross section in each column [m], shape (rows, columns).

    Every column spreads its points by the folds that it crosses: rows run along the crests, and no crest is
    cut into teeth; columns keep level with each other over 3 cm.

    Args:
        surface: The colon.
        theta: Angles of the columns, the last one a full turn after the first [rad], shape (columns,).
        start: Arc length of the first row [m].
        end: Arc length of the last row [m].
        rows: Number of rows.
    """
    fine = np.linspace(start, end, 6 * rows)
    density = np.stack([_density(surface, fine, angle) for angle in theta[:-1]], 1)
    density /= gaussian_filter1d(density, _EVEN_OUT / (fine[1] - fine[0]), axis=0, mode="nearest")
    density = gaussian_filter1d(density, len(theta) / 36, axis=1, mode="wrap")
    density *= gaussian_filter1d(_demand(surface, fine), 60.0, mode="nearest")[:, None]
    share = np.cumsum(0.5 * (density[1:] + density[:-1]), axis=0)
    share = np.concatenate([np.zeros((1, share.shape[1])), share]) / share[-1]
    even = np.linspace(0.0, 1.0, rows)
    columns = [np.interp(even, share[:, k], fine) for k in range(share.shape[1])]
    return np.stack([*columns, columns[0]], 1)


def _density(surface: Surface, s: np.ndarray, angle: float) -> np.ndarray:
    """Return how closely rows lie along one column, shape like ``s``."""
    theta = np.full_like(s, angle)
    sector, phi = surface.sector(theta)
    density = _BETWEEN_FOLDS + nearness(surface.rows[int(sector[0])], s, phi, _NEAR)
    for valve in surface.valves:
        density += valve_height(valve, s, theta, 2 * valve.width) / valve.depth
    return density


def _demand(surface: Surface, s: np.ndarray) -> np.ndarray:
    """Return how many rows a stretch needs: half as many where there are no folds."""
    start = surface.curve.bounds("sigmoid")[0]
    valves = sum((np.abs(s - valve.s) < 0.012) * 0.5 for valve in surface.valves)
    return np.where(s < start, 0.5 + valves, 1.0)
