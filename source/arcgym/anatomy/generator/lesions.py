# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Diverticula, polyps and the caecum's openings: where they are and how they shape the surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from arcgym.anatomy.generator.spec import PolypSpec
from arcgym.anatomy.generator.surface import DOME_LENGTH, SEAM_MARGIN, Surface
from arcgym.anatomy.segments import SEGMENTS

WIDE_NECK = 0.007
"""Neck radius from which a diverticulum is also in the simulated wall [m]: a 13 mm colonoscope fits into it."""

_BEND_NEAR, _BEND_SHARE = 0.02, 0.5
"""How near a bend counts [m], and how far towards its centre a wide sac may reach as a share of its radius."""

_PARIS = {"Ip": ("pedunculated", 1.2), "Is": ("sessile", 1.1), "IIa": ("flat", 0.45)}
"""Kind of lesion, and its height over its radius, by Paris class."""


@dataclass(frozen=True)
class Lesion:
    """A round patch of the surface that bulges out (diverticulum) or in (polyp)."""

    kind: str
    """``diverticulum``, ``sessile``, ``pedunculated`` or ``flat`` (Paris Is, Ip, IIa), ``valve`` or ``appendix``."""
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
        return self.size * {"diverticulum": 1.9, "appendix": 2.4}.get(self.kind, 1.45)


def place_lesions(surface: Surface, rng: np.random.Generator) -> list[Lesion]:
    """Places the lesions that the spec asks for, off the folds and off each other.

    Raises:
        ValueError: A segment has no room for its lesions.
    """
    lesions = _openings(surface) if surface.spec.openings else []
    for polyp in sorted(surface.spec.polyp_list, key=lambda polyp: -polyp.diameter):
        lesions.append(_place(surface, polyp.segment, polyp, lesions, rng))
    for name in SEGMENTS:
        segment = surface.spec.segments[name]
        kinds = ["wide diverticulum"] * segment.wide_diverticula
        kinds += ["diverticulum"] * (segment.diverticula - segment.wide_diverticula) + ["polyp"] * segment.polyps
        for kind in kinds:
            lesions.append(_place(surface, name, kind, lesions, rng))
    return lesions


def _openings(surface: Surface) -> list[Lesion]:
    """Places the ileocaecal valve on its fold at the medial wall, the appendix orifice 28 mm below."""
    s, theta = surface.ileum
    below = min(s + 0.028, surface.curve.length - DOME_LENGTH - 0.008)
    angle = surface.medial_angle(below)
    return [Lesion("valve", s, theta, 0.011, 0.0065, 1.0), Lesion("appendix", below, angle, 0.0028, 0.005, 1.0)]


def _meets(surface: Surface, row: int, theta: float) -> bool:
    """Tells whether the folds of a row reach to an angle."""
    return bool(np.cos(theta - surface.taenia - (row + 0.5) * 2 * np.pi / 3) > 0.3)


def _place(
    surface: Surface, name: str, kind: str | PolypSpec, others: list[Lesion], rng: np.random.Generator
) -> Lesion:
    start, end = surface.curve.bounds(name)
    low = start + 0.012
    high = max(min(end - 0.012, surface.curve.length - 0.05), low + 0.002)
    for _ in range(4000):
        s = rng.uniform(low, high)
        lesion = _draw(surface, kind, s, rng.uniform(SEAM_MARGIN, 2 * np.pi - SEAM_MARGIN), rng)
        if _off_folds(surface, lesion) and all(_apart(surface, lesion, other) for other in others):
            return lesion
    raise ValueError(f"ColonSpec.segments['{name}']: no room for another {kind}; ask for fewer.")


def _draw(surface: Surface, kind: str | PolypSpec, s: float, theta: float, rng: np.random.Generator) -> Lesion:
    spec = surface.spec
    if isinstance(kind, PolypSpec):
        shape, height = _PARIS[kind.paris]
        return Lesion(shape, s, theta, 0.5 * kind.diameter, 0.5 * kind.diameter * height, 1.0)
    if kind == "wide diverticulum":
        s, theta = _between_rings(surface, s, theta)
        return Lesion("diverticulum", s, theta, rng.uniform(*spec.wide_neck), rng.uniform(0.011, 0.014), 1.15)
    if kind == "diverticulum":
        neck = rng.uniform(*spec.diverticulum_neck)
        return Lesion(kind, s, theta, neck, rng.uniform(0.006, 0.010), rng.uniform(1.25, 1.6))
    radius = rng.uniform(*spec.polyp_radius)
    shape = "pedunculated" if rng.uniform() < 0.4 else "sessile"
    return Lesion(shape, s, theta, radius, radius * rng.uniform(0.9, 1.5), 1.0)


def _between_rings(surface: Surface, s: float, theta: float) -> tuple[float, float]:
    """Returns the middle of the wall's cell at a place: its four vertices then carry the sac together."""
    arc, step = surface.ring_arc(), 2 * np.pi / surface.spec.sectors
    k = int(np.clip(np.searchsorted(arc, s), 1, len(arc) - 1))
    return float(0.5 * (arc[k - 1] + arc[k])), float((np.floor(theta / step) + 0.5) * step)


def _off_folds(surface: Surface, lesion: Lesion) -> bool:
    """Tells whether there is no fold or rectal valve on the patch, nor the inside of a bend behind a wide sac."""
    wide = lesion.kind == "diverticulum" and lesion.size >= WIDE_NECK
    if wide:
        s = lesion.s + np.array([-_BEND_NEAR, 0.0, _BEND_NEAR])
        bend = surface.curve.interpolate(s, surface.curve.curvature_vector)
        towards = (bend * surface.outwards(s, np.full(3, lesion.theta))).sum(1).max()
        if towards * (float(surface.lumen_radius(s)[1]) + lesion.depth) > _BEND_SHARE:
            return False
    if any(abs(lesion.s - valve.s) < lesion.patch + 0.012 for valve in surface.valves):
        return False
    near = [np.abs(row.s - lesion.s).min() for k, row in enumerate(surface.rows) if _meets(surface, k, lesion.theta)]
    return all(distance >= (0.9 if wide else 0.75) * lesion.patch for distance in near)


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
    if lesion.kind in ("valve", "appendix"):
        spread, rise, tint = (_lips if lesion.kind == "valve" else _dimple)(lesion, t, angle)
        return spread, rise, tint, 1.0 - _ramp(0.75, 1.0, t)
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


def _lips(lesion: Lesion, t: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two lips across the lumen's length with a slit between them, as the ileocaecal valve shows them from below."""
    along, around = t * np.cos(angle), t * np.sin(angle)
    slit = np.exp(-((along / 0.12) ** 2)) * (1.0 - _ramp(0.45, 0.75, np.abs(around)))
    mound = np.sqrt(np.clip(1.0 - (along / 0.75) ** 2 - (around / 0.95) ** 2, 0.0, 1.0))
    return lesion.patch * t, -lesion.depth * mound * (1.0 - 0.85 * slit), -0.45 * slit


def _dimple(lesion: Lesion, t: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A narrow pit with a crescent of mucosa round half of it: the appendix orifice."""
    pit = np.exp(-((t / 0.32) ** 2))
    rim = np.exp(-(((t - 0.55) / 0.14) ** 2)) * (0.6 + 0.4 * np.cos(angle))
    return lesion.patch * t, lesion.depth * pit - 0.0013 * rim, -0.45 * pit


def wall_bulge(surface: Surface, lesions: Sequence[Lesion], s: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Returns how far diverticula that a tip can enter push the simulated wall out [m], shape like ``s``."""
    bulge = np.zeros_like(s)
    for lesion in lesions:
        if lesion.kind == "diverticulum" and lesion.size >= WIDE_NECK:
            share = distance_to(surface, lesion, s, theta) / lesion.patch
            bulge = np.maximum(bulge, lesion.depth * (1.0 - _ramp(0.6, 1.1, share)))
    return bulge


def _ramp(low: float, high: float, x: np.ndarray) -> np.ndarray:
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
