# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Diverticula and polyps: where they are and how they shape the visual surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from .segments import SEGMENTS
from .surface import Surface


@dataclass(frozen=True)
class Lesion:
    """A round patch of the surface that bulges out (diverticulum) or in (polyp)."""

    kind: str
    """``diverticulum``, ``sessile`` or ``pedunculated`` (Paris Is, Ip)."""
    s: float
    """Arc length of its middle [m]."""
    theta: float
    """Angle of its middle [rad]."""
    size: float
    """Radius of the diverticulum's neck or of the polyp's head [m]."""
    depth: float
    """Depth of the diverticulum or height of the polyp [m]."""
    swell: float
    """Widest radius of the sac over that of the neck; 1 for polyps."""

    @property
    def patch(self) -> float:
        """Radius of the surface that it deforms [m]."""
        return self.size * (1.9 if self.kind == "diverticulum" else 1.45)


def place_lesions(surface: Surface, rng: np.random.Generator) -> list[Lesion]:
    """Places the lesions that the spec asks for, off the folds and off each other.

    Raises:
        ValueError: A segment has no room for its lesions.
    """
    lesions: list[Lesion] = []
    for name in SEGMENTS:
        segment = surface.spec.segments[name]
        for kind, count in (("diverticulum", segment.diverticula), ("polyp", segment.polyps)):
            for _ in range(count):
                lesions.append(_place(surface, name, kind, lesions, rng))
    return lesions


def _place(surface: Surface, name: str, kind: str, others: list[Lesion], rng: np.random.Generator) -> Lesion:
    start, end = surface.curve.bounds(name)
    for _ in range(4000):
        s = rng.uniform(start + 0.012, min(end - 0.012, surface.curve.length - 0.05))
        lesion = _draw(surface, kind, s, rng.uniform(0.7, 2 * np.pi - 0.7), rng)
        if _off_folds(surface, lesion) and all(_apart(surface, lesion, other) for other in others):
            return lesion
    raise ValueError(f"ColonSpec.segments['{name}']: no room for another {kind}; ask for fewer.")


def _draw(surface: Surface, kind: str, s: float, theta: float, rng: np.random.Generator) -> Lesion:
    spec = surface.spec
    if kind == "diverticulum":
        neck = rng.uniform(*spec.diverticulum_neck)
        return Lesion(kind, s, theta, neck, rng.uniform(0.006, 0.010), rng.uniform(1.25, 1.6))
    radius = rng.uniform(*spec.polyp_radius)
    shape = "pedunculated" if rng.uniform() < 0.4 else "sessile"
    return Lesion(shape, s, theta, radius, radius * rng.uniform(0.9, 1.5), 1.0)


def _off_folds(surface: Surface, lesion: Lesion) -> bool:
    if any(abs(lesion.s - valve.s) < lesion.patch + 0.012 for valve in surface.valves):
        return False
    for k, row in enumerate(surface.rows):
        middle = surface.taenia + (k + 0.5) * 2 * np.pi / 3
        if np.cos(lesion.theta - middle) > 0.3 and np.abs(row.s - lesion.s).min() < 0.75 * lesion.patch:
            return False
    return True


def _apart(surface: Surface, lesion: Lesion, other: Lesion) -> bool:
    radius = float(surface.lumen_radius(np.array(lesion.s)))
    around = radius * abs(np.mod(lesion.theta - other.theta + np.pi, 2 * np.pi) - np.pi)
    return bool(np.hypot(lesion.s - other.s, around) > 1.3 * (lesion.patch + other.patch))


def distance_to(surface: Surface, lesion: Lesion, s: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Returns the distance on the unrolled surface from each point to a lesion's middle [m]."""
    radius = float(surface.lumen_radius(np.array(lesion.s)))
    return np.hypot(s - lesion.s, (theta - lesion.theta) * radius)


def shape_lesion(
    surface: Surface, lesion: Lesion, s: np.ndarray, theta: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Moves the surface points of one patch onto the lesion.

    Args:
        surface: The colon.
        lesion: The lesion.
        s: Arc lengths of the points, all within the patch [m], shape (n,).
        theta: Their angles [rad], shape (n,).
        points: Their positions on the plain surface [m], shape (n, 3).

    Returns:
        New positions, shape (n, 3), and tint, shape (n,).
    """
    at, angle = np.array([lesion.s]), np.array([lesion.theta])
    tangent, outwards = surface.curve.frame(at)[0][0], surface.outwards(at, angle)[0]
    radius = float(surface.radius(at, angle)[0])
    base = surface.curve.position(at)[0] + radius * outwards
    along, around = s - lesion.s, (theta - lesion.theta) * float(surface.lumen_radius(at)[0])
    share = np.hypot(along, around) / lesion.patch
    direction = np.stack([along, around], 1) / np.maximum(share * lesion.patch, 1e-9)[:, None]
    spread, rise, tint, blend = _profile(lesion, share, np.arctan2(direction[:, 1], direction[:, 0]))
    flat = direction[:, :1] * tangent + direction[:, 1:] * np.cross(tangent, outwards)
    target = base + spread[:, None] * flat + rise[:, None] * outwards
    return points + blend[:, None] * (target - points), tint


def _profile(lesion: Lesion, t: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Returns distance from the axis, height along the outward axis, tint and weight at shares ``t`` of the patch."""
    if lesion.kind == "diverticulum":
        spread, rise = _sac(lesion, t)
        return spread, rise, -np.clip(1.3 * rise / lesion.depth, 0.0, 1.0), 1.0 - _ramp(0.85, 1.0, t)
    spread, rise = (_stalk if lesion.kind == "pedunculated" else _dome)(lesion, t)
    lobes = 1 + 0.10 * np.sin(3 * angle + 1e3 * lesion.s) * t + 0.06 * np.sin(5 * angle + 9 * t)
    return spread, rise * lobes, 1.0 - _ramp(0.70, 0.95, t), 1.0 - _ramp(0.82, 1.0, t)


def _sac(lesion: Lesion, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A sac behind a narrower neck with a rounded rim."""
    knots = [0.0, 0.13, 0.27, 0.40, 0.52, 0.62, 0.72, 0.80, 0.90, 1.0]
    neck, sac = lesion.size, lesion.size * lesion.swell
    spread = [
        0,
        0.58 * sac,
        0.93 * sac,
        sac,
        0.5 * (sac + neck),
        0.94 * neck,
        neck,
        1.12 * neck,
        1.45 * neck,
        1.9 * neck,
    ]
    rise = np.array([1.1, 1.05, 0.85, 0.60, 0.38, 0.22, 0.09, 0.02, 0.0, 0.0]) * lesion.depth
    return PchipInterpolator(knots, spread)(np.minimum(t, 1)), PchipInterpolator(knots, rise)(np.minimum(t, 1))


def _stalk(lesion: Lesion, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A round head on a narrower stalk."""
    knots = [0, 0.2, 0.4, 0.55, 0.68, 0.78, 0.88, 1.0]
    spread = [*(share * lesion.size for share in (0, 0.6, 0.97, 0.92, 0.62, 0.60, 0.8)), lesion.patch]
    rise = np.array([1.0, 0.93, 0.75, 0.55, 0.33, 0.15, 0.03, 0.0]) * lesion.depth
    rise[:3] += np.array([0.5, 0.5, 0.3]) * lesion.size
    return np.interp(t, knots, spread), -np.interp(t, knots, rise)


def _dome(lesion: Lesion, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A broad-based bump."""
    spread = lesion.patch * t * (1 - 0.25 * np.sin(np.pi * np.clip(t, 0, 1)))
    cap = np.sqrt(np.clip(1 - (t / 0.85) ** 2, 0, 1))
    return spread, -lesion.depth * (0.75 * cap + 0.05 * np.clip(1 - t, 0, 1))


def _ramp(low: float, high: float, x: np.ndarray) -> np.ndarray:
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
