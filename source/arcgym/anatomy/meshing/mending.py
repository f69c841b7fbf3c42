# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Mend a wall of rings and sectors where its elements are bad, it crosses itself, or its lumen is too narrow."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter

from arcgym.anatomy.measures import tet_quality
from arcgym.anatomy.meshing.lumen_grid import ring_centers
from arcgym.anatomy.meshing.wall import build_wall
from arcgym.anatomy.validation.mesh_checks import boundary_faces, find_crossings

_LEAST_QUALITY = 0.06
"""Quality of an element below which the wall is smoothed there; half more than a valid wall needs."""

_LEAST_DISTANCE = 0.0032
"""Distance of neighboring rings in the outer layer below which they are moved apart [m]."""

_ROUNDS = 40
"""Largest number of times that the wall is mended."""

_CROSSINGS_EVERY = 4
"""Rounds between two searches for crossings, which are slow."""

_STEP = 0.35
"""Share of the way to the mean of the neighbors, and step inwards at crossings of two loops [mm], in a round."""

_ONE_STRETCH = 6
"""Rings that an edge and a face that cross may lie apart and still belong to one bend."""


def mend_wall(layers: np.ndarray, thickness: float, least_radius: float) -> np.ndarray:
    """Return the wall's layers mended, shape (2, R, S, 3); the outer side keeps its directions from the inner one.

    Args:
        layers: Positions of layer, ring and sector [m], shape (2, R, S, 3).
        thickness: Thickness of the wall [m].
        least_radius: Least distance of inner vertices from the center of their ring [m].

    Raises:
        ValueError: Elements stay inverted; says at which rings.
    """
    inner, offset = layers[0].copy(), layers[1] - layers[0]
    bend = loops = np.zeros(inner.shape[:2])
    for turn in range(_ROUNDS + 1):
        inner = _widened(inner, least_radius)
        now = np.stack([inner, inner + offset])
        bad, lack = (_quality(now) < _LEAST_QUALITY).astype(float), _lack(now[1])
        if turn % _CROSSINGS_EVERY == 0 or not (bad.any() or lack.any() or bend.any() or loops.any()):
            bend, loops = _crossings(now)
        if not (bad.any() or lack.any() or bend.any() or loops.any()):
            return now
        inner, offset = _mended(inner, offset, np.maximum(bad, bend), loops, thickness)
        inner[1:-1] += _spread(now[1], lack)[1:-1]
    now = np.stack([inner, inner + offset])
    wrong = np.flatnonzero((_quality(now) <= 0.0).any(1))
    if len(wrong):
        raise ValueError(
            f"The wall folds over itself at rings {wrong[:6].tolist()} of {len(inner)}; expected elements of positive"
            " volume. Widen the lumen there, take loops further apart, or make the wall thinner."
        )
    return now


def _mended(
    inner: np.ndarray, offset: np.ndarray, bend: np.ndarray, loops: np.ndarray, thickness: float
) -> tuple[np.ndarray, np.ndarray]:
    """Smooth positions and directions where a bend is bad, and draw loops that cross in."""
    soft = _soft(bend)[..., None]
    mean = 0.25 * (np.roll(inner, 1, 1) + np.roll(inner, -1, 1) + _next(inner, 1) + _next(inner, -1))
    mean[[0, -1]] = inner[[0, -1]]
    moved = inner + _STEP * soft * (mean - inner)
    turned = 0.25 * (np.roll(offset, 1, 1) + np.roll(offset, -1, 1) + _next(offset, 1) + _next(offset, -1))
    size = np.linalg.norm(offset, axis=2, keepdims=True)
    offset = offset + _STEP * soft * (turned - offset)
    offset *= size / np.maximum(np.linalg.norm(offset, axis=2, keepdims=True), 1e-9)
    moved -= 1e-3 * _STEP * _soft(loops)[..., None] * offset / thickness
    return moved, offset


def _next(values: np.ndarray, step: int) -> np.ndarray:
    """Return the values of the next or the previous ring, those of the end rings their own."""
    return np.concatenate([values[1:], values[-1:]] if step > 0 else [values[:1], values[:-1]])


def _soft(mark: np.ndarray) -> np.ndarray:
    return np.maximum(mark, gaussian_filter(mark.astype(float), (0.7, 0.9), mode=("nearest", "wrap")))


def _widened(inner: np.ndarray, least: float) -> np.ndarray:
    center = ring_centers(inner)[0][:, None]
    spoke = inner - center
    length = np.maximum(np.linalg.norm(spoke, axis=2, keepdims=True), 1e-9)
    return center + spoke * np.maximum(1.0, least / length)


def _quality(layers: np.ndarray) -> np.ndarray:
    """Return the least quality of the elements at each vertex of the grid, shape (R, S)."""
    rings, sectors = layers.shape[1:3]
    wall = build_wall(layers, np.zeros(rings, int), np.arange(rings))
    quality = np.full(rings * sectors, np.inf)
    np.minimum.at(quality, wall.tets.ravel() % len(quality), np.repeat(tet_quality(wall.points, wall.tets), 4))
    return quality.reshape(rings, sectors)


def _lack(outer: np.ndarray) -> np.ndarray:
    """Return by how much neighboring rings are too near each other [m], shape (R - 1, S)."""
    return np.maximum(_LEAST_DISTANCE - np.linalg.norm(np.diff(outer, axis=0), axis=2), 0.0)


def _spread(outer: np.ndarray, lack: np.ndarray) -> np.ndarray:
    """Return a shift of the vertices that takes rings apart where they are too near, shape (R, S, 3)."""
    step = np.diff(outer, axis=0)
    step *= (0.6 * lack / np.maximum(np.linalg.norm(step, axis=2), 1e-9))[..., None]
    shift = np.zeros_like(outer)
    shift[1:] += step
    shift[:-1] -= step
    return shift


def _crossings(layers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mark vertices where the wall crosses itself within a bend, and between loops, shape (R, S) each."""
    rings, sectors = layers.shape[1:3]
    wall = build_wall(layers, np.zeros(rings, int), np.arange(rings))
    found = find_crossings(wall.points, boundary_faces(wall.tets)) % (rings * sectors)
    near = np.ptp(found // sectors, axis=1) <= _ONE_STRETCH if len(found) else np.zeros(0, bool)
    marks = np.zeros((2, rings * sectors))
    marks[0, found[near].ravel()] = 1.0
    marks[1, found[~near].ravel()] = 1.0
    return marks[0].reshape(rings, sectors), marks[1].reshape(rings, sectors)
