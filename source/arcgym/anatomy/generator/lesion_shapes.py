# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Form of diverticula, polyps and the cecum's openings on the visual surface, and of wide sacs in the wall."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import PchipInterpolator

from arcgym.anatomy.blending import smooth_step
from arcgym.anatomy.generator.lesions import WIDE_NECK, Lesion
from arcgym.anatomy.generator.surface import Surface


def distance_to(surface: Surface, lesion: Lesion, s: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Return the distance on the unrolled surface from each point to a lesion's middle [m]."""
    radius = float(surface.lumen_radius(np.array(lesion.s)))
    return np.hypot(s - lesion.s, (theta - lesion.theta) * radius)


def shape_lesion(
    surface: Surface, lesion: Lesion, s: np.ndarray, theta: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Move the surface points of one patch onto the lesion.

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
    tangent, outwards = surface.curve.frame(at)[0][0], surface.curve.outwards(at, angle)[0]
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
    """Return distance from the axis, height along the outward axis, tint and weight at shares ``t`` of the patch."""
    if lesion.kind in ("valve", "appendix"):
        spread, rise, tint = (_lips if lesion.kind == "valve" else _dimple)(lesion, t, angle)
        return spread, rise, tint, 1.0 - smooth_step(0.75, 1.0, t)
    if lesion.kind == "diverticulum":
        spread, rise = _sac(lesion, t)
        return spread, rise, -np.clip(1.3 * rise / lesion.depth, 0.0, 1.0), 1.0 - smooth_step(0.85, 1.0, t)
    spread, rise = (_stalk if lesion.kind == "pedunculated" else _dome)(lesion, t)
    lobes = 1 + 0.10 * np.sin(3 * angle + 1e3 * lesion.s) * t + 0.06 * np.sin(5 * angle + 9 * t)
    return spread, rise * lobes, 1.0 - smooth_step(0.70, 0.95, t), 1.0 - smooth_step(0.82, 1.0, t)


def _sac(lesion: Lesion, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return spread and rise of a sac behind a narrower neck with a rounded rim."""
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
    """Return spread and rise of a round head on a narrower stalk."""
    knots = [0, 0.2, 0.4, 0.55, 0.68, 0.78, 0.88, 1.0]
    spread = [*(share * lesion.size for share in (0, 0.6, 0.97, 0.92, 0.62, 0.60, 0.8)), lesion.patch]
    rise = np.array([1.0, 0.93, 0.75, 0.55, 0.33, 0.15, 0.03, 0.0]) * lesion.depth
    rise[:3] += np.array([0.5, 0.5, 0.3]) * lesion.size
    return np.interp(t, knots, spread), -np.interp(t, knots, rise)


def _dome(lesion: Lesion, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return spread and rise of a broad-based bump."""
    spread = lesion.patch * t * (1 - 0.25 * np.sin(np.pi * np.clip(t, 0, 1)))
    cap = np.sqrt(np.clip(1 - (t / 0.85) ** 2, 0, 1))
    return spread, -lesion.depth * (0.75 * cap + 0.05 * np.clip(1 - t, 0, 1))


def _lips(lesion: Lesion, t: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return spread, rise and tint of two lips with a slit between them, as the ileocecal valve shows from below."""
    along, around = t * np.cos(angle), t * np.sin(angle)
    slit = np.exp(-((along / 0.12) ** 2)) * (1.0 - smooth_step(0.45, 0.75, np.abs(around)))
    mound = np.sqrt(np.clip(1.0 - (along / 0.75) ** 2 - (around / 0.95) ** 2, 0.0, 1.0))
    return lesion.patch * t, -lesion.depth * mound * (1.0 - 0.85 * slit), -0.45 * slit


def _dimple(lesion: Lesion, t: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return spread, rise and tint of a pit with a crescent of mucosa round half of it, as the appendix's orifice."""
    pit = np.exp(-((t / 0.32) ** 2))
    rim = np.exp(-(((t - 0.55) / 0.14) ** 2)) * (0.6 + 0.4 * np.cos(angle))
    return lesion.patch * t, lesion.depth * pit - 0.0013 * rim, -0.45 * pit


def wall_bulge(surface: Surface, lesions: Sequence[Lesion], s: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Return how far diverticula that a tip can enter push wall and contact surface out [m], shape like ``s``."""
    bulge = np.zeros_like(s)
    for lesion in lesions:
        if lesion.kind == "diverticulum" and lesion.size >= WIDE_NECK:
            share = distance_to(surface, lesion, s, theta) / lesion.patch
            bulge = np.maximum(bulge, lesion.depth * (1.0 - smooth_step(0.6, 1.1, share)))
    return bulge
