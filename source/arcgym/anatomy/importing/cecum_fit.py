# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Fit a bent bullet to the wall of the cecum; its axis ends at the pole.

A cecum is nearly a ball: its deepest point depends on where one looks from, and folds move it by centimeters. The
pole is the end of the axis along which the lumen runs in, so the whole cecum is fitted: a tube round an arc, closed by
a dome.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.optimize import least_squares
from scipy.spatial import cKDTree

from arcgym.anatomy.blending import smooth_step
from arcgym.anatomy.curve import Curve
from arcgym.anatomy.importing.blind_end import blind_end
from arcgym.anatomy.importing.polar import cast_rings
from arcgym.anatomy.voxel_grid import Grid


@dataclass(frozen=True)
class CecumFitSettings:
    """Expected shape of a cecum, with its weights, and how far the fit may change a path.

    Our choices, set on generated colons, the five patients among them (docs/importing.md, "How well").
    """

    forward_bend: float = 8.0
    """Expected curvature of the axis forwards, as the cecum turns on the iliacus to the abdominal wall [1/m]. Its
    weight is small: it decides only where the wall leaves the axis open."""
    bend_weight: float = 1.5
    """Weight of that curvature: one over its standard deviation [m]."""
    aspect: float = 0.93
    """Expected length of the dome over its radius."""
    aspect_deviation: float = 0.02
    """Standard deviation of that ratio."""
    taper_deviation: float = 0.2
    """Standard deviation of the growth of the radius along the axis."""
    window: float = 2.2
    """Length of the cecum that is fitted, from a radius before the end of the path, in radii."""
    fold_weight: float = 0.35
    """Weight of wall inside of the fitted surface, where folds reach, over that of wall outside."""
    roughness: float = 0.003
    """Distance of the wall from the fitted surface that is expected [m]."""
    most_points: int = 1500
    """Number of wall voxels that are fitted."""
    radius_range: tuple[float, float] = (0.008, 0.040)
    """Least and largest radius of a cecum [m]."""
    largest_turn: float = 0.5
    """Largest shift of the axis's base, in radii; beyond, the path stays as it was."""
    largest_move: float = 0.035
    """Largest shift of the pole [m]; beyond, the path stays as it was."""
    largest_miss: float = 0.025
    """Largest distance of the fitted pole from the blind end [m]; beyond, the path is led to the blind end. Of 20 ceca
    with the fit right it was 6 to 17 mm, in both from CT 18 and 20 mm, in three with a bulge fitted 34 to 40 mm."""
    turn_in: float = 1.6
    """Distance from the blind end at which a path is turned to it, in radii."""
    turns: tuple[float, ...] = (0.5, 0.3, 0.1)
    """How far the turn goes on straight first, over that distance: the first is taken that stays in the lumen."""
    step: float = 0.003
    """Distance of points along the path [m]."""


SETTINGS = CecumFitSettings()


@dataclass(frozen=True)
class _Frame:
    """Start of a fit: a point on the axis, the direction to the pole and two directions across it."""

    base: np.ndarray
    direction: np.ndarray
    across: np.ndarray


@dataclass(frozen=True)
class _Bullet:
    """A tube round an arc, closed by half an ellipsoid."""

    base: np.ndarray
    """Start of the axis [m], shape (3,)."""
    direction: np.ndarray
    """Its unit direction there, shape (3,)."""
    bend: np.ndarray
    """Curvature vector, across ``direction`` [1/m], shape (3,)."""
    length: float
    """Length of the axis to the pole [m]."""
    radius: float
    """Radius where the dome begins [m]."""
    taper: float
    """Growth of the tube's radius along the axis."""
    aspect: float
    """Length of the dome over its radius."""

    def position(self, t: np.ndarray) -> np.ndarray:
        """Return points of the axis at arc lengths ``t`` from its base [m], shape (n, 3)."""
        curvature = np.linalg.norm(self.bend) + 1e-9
        turned, towards = curvature * t[:, None], self.bend / curvature
        return self.base + (np.sin(turned) * self.direction + (1.0 - np.cos(turned)) * towards) / curvature

    def excess(self, points: np.ndarray) -> np.ndarray:
        """Return how far points are outside of the surface, negative inside [m], shape (n,)."""
        curvature = np.linalg.norm(self.bend) + 1e-9
        offset, towards = points - self.base, self.bend / curvature
        along, inwards = offset @ self.direction, offset @ towards
        aside = offset - np.outer(along, self.direction) - np.outer(inwards, towards)
        t = np.arctan2(along, 1.0 / curvature - inwards) / curvature
        out = np.hypot(along, 1.0 / curvature - inwards) - 1.0 / curvature
        dome = self.aspect * self.radius
        radius = np.maximum(self.radius + self.taper * (t - self.length + dome), 0.3 * self.radius)
        beyond = np.maximum((t - self.length) / dome + 1.0, 0.0)
        return (np.sqrt(beyond**2 + (out**2 + (aside**2).sum(1)) / radius**2) - 1.0) * radius


def lead_to_fitted_pole(grid: Grid, points: np.ndarray) -> np.ndarray:
    """Lead the last of a centerline along the fitted axis of the cecum to its pole.

    Args:
        grid: The lumen, +X right, +Y anterior, +Z cranial.
        points: Centerline from the anus to the wall of the cecum [m], evenly spaced, shape (n, 3).

    Returns:
        The centerline, its last part replaced; led to the blind end where the fit ends far from it; as it was where the
        fit leads far away.
    """
    curve = Curve(points, np.linspace(0.0, 1.0, 9)[1:])
    radius = _typical_radius(grid, curve)
    start = curve.length - (1.0 + SETTINGS.window) * radius
    if start < 0.2 * curve.length:
        return points
    base, last = curve.position(np.array([start, curve.length - radius]))
    reach = float(np.linalg.norm(last - base))
    bullet = _fit(_wall_points(grid, curve, start, radius), base, (last - base) / reach, reach + radius, radius)
    axis = _axis(grid, bullet)
    end = blind_end(grid, curve, start, radius)
    moved = np.linalg.norm(axis[-1] - points[-1])
    if moved > SETTINGS.largest_move or np.linalg.norm(bullet.base - base) > SETTINGS.largest_turn * radius:
        led = points
    else:
        led = _blended(curve, start, axis)
    return led if np.linalg.norm(led[-1] - end) < SETTINGS.largest_miss else _turned_to(grid, points, end, radius)


def _turned_to(grid: Grid, points: np.ndarray, end: np.ndarray, radius: float) -> np.ndarray:
    """Return the centerline turned to the blind end in the widest parabola inside; as it was where none is."""
    near = np.linalg.norm(points - end, axis=1) < SETTINGS.turn_in * radius
    first = int(near.argmax())
    if first < 2:
        return points
    ahead = points[first] - points[first - 2]
    ahead *= np.linalg.norm(end - points[first]) / np.linalg.norm(ahead)
    t = np.linspace(0.0, 1.0, 40)[:, None]
    for share in SETTINGS.turns:
        arc = points[first] + 2.0 * t * (1.0 - t) * share * ahead + t**2 * (end - points[first])
        if (grid.sample(arc[:-4]) > 0.5).all():
            return np.concatenate([points[:first], arc])
    return points


def _typical_radius(grid: Grid, curve: Curve) -> float:
    """Return the radius between folds near the end [m]."""
    s = np.arange(curve.length - 0.08, curve.length - 0.015, SETTINGS.step)
    between = np.quantile(cast_rings(grid, curve, s, 48), 0.7, axis=1)
    return float(np.clip(np.median(between), *SETTINGS.radius_range))


def _wall_points(grid: Grid, curve: Curve, start: float, radius: float) -> np.ndarray:
    """Return voxels at the wall, beyond an arc length and not far from the curve [m], shape (n, 3)."""
    s = np.arange(0.0, curve.length, SETTINGS.step)
    line = curve.position(s)
    near = line[s >= start]
    low = np.maximum(np.floor(grid.index(near.min(0) - 1.6 * radius)).astype(int), 0)
    high = np.minimum(np.ceil(grid.index(near.max(0) + 1.6 * radius)).astype(int) + 1, grid.values.shape)
    part = grid.values[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] > 0.5
    wall = grid.points(np.argwhere(part & ~ndimage.binary_erosion(part, border_value=1)) + low)
    distance, nearest = cKDTree(line).query(wall)
    wall = wall[(s[nearest] >= start) & (distance < 1.5 * radius)]
    return np.random.default_rng(0).permutation(wall)[: SETTINGS.most_points]


def _fit(wall: np.ndarray, base: np.ndarray, direction: np.ndarray, length: float, radius: float) -> _Bullet:
    """Return the bullet whose surface most of the wall lies on; folds, which reach inwards, count less."""
    across = np.linalg.svd(direction[None])[2][1:]
    frame = _Frame(base, direction, across)
    first = np.r_[np.zeros(6), length, radius, 0.0, SETTINGS.aspect]
    scale = np.r_[0.01, 0.01, 0.3, 0.3, 3.0, 3.0, 0.02, 0.01, 0.1, 0.01]
    wanted = SETTINGS.forward_bend * across[:, 1]

    def residuals(values: np.ndarray) -> np.ndarray:
        excess = _bullet(frame, values).excess(wall)
        rough = np.where(excess < 0, SETTINGS.fold_weight, 1.0) * excess / SETTINGS.roughness
        expected = np.r_[
            SETTINGS.bend_weight * (values[4:6] - wanted),
            values[8] / SETTINGS.taper_deviation,
            (values[9] - SETTINGS.aspect) / SETTINGS.aspect_deviation,
        ]
        return np.r_[np.sqrt(np.log1p(rough**2) * 2500 / max(len(wall), 1)), expected]

    starts = [np.r_[first[:4], bend, first[6:]] for bend in (wanted, -wanted)]
    fits = [least_squares(residuals, start, x_scale=scale, ftol=1e-4, max_nfev=60) for start in starts]
    return _bullet(frame, min(fits, key=lambda fit: fit.cost).x)


def _bullet(frame: _Frame, values: np.ndarray) -> _Bullet:
    """Build a bullet from shifts (2), turns (2) and curvatures (2) across the frame, length, radius and shape."""
    direction = frame.direction + values[2:4] @ frame.across
    direction /= np.linalg.norm(direction)
    bend = values[4:6] @ frame.across
    bend = bend - (bend @ direction) * direction
    return _Bullet(frame.base + values[:2] @ frame.across, direction, bend, *map(float, values[6:]))


def _axis(grid: Grid, bullet: _Bullet) -> np.ndarray:
    """Return the axis from the bullet's base to where it leaves the lumen [m], shape (n, 3)."""
    t = np.arange(0.0, bullet.length + bullet.radius, 0.5 * SETTINGS.step)
    points = bullet.position(t)
    out = (grid.sample(points) < 0.5) & (t > bullet.length - bullet.radius)
    return points[: int(out.argmax())] if out.any() else points[t <= bullet.length]


def _blended(curve: Curve, start: float, axis: np.ndarray) -> np.ndarray:
    """Return the curve, passing over to the axis in the axis' first half."""
    before = curve.position(np.arange(0.0, start, SETTINGS.step))
    arc = 0.5 * SETTINGS.step * np.arange(len(axis))
    share = smooth_step(0.0, 1.0, 2.0 * arc / arc[-1])[:, None]
    return np.concatenate([before, (1.0 - share) * curve.position(start + arc) + share * axis])
