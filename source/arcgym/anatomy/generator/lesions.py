# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Diverticula, polyps and the cecum's openings: where they are. Their form is in :mod:`lesion_shapes`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from arcgym.anatomy.generator.conditions import effective_segment
from arcgym.anatomy.generator.spec import PolypSpec
from arcgym.anatomy.generator.surface import DOME_LENGTH, SEAM_MARGIN, Surface
from arcgym.anatomy.segments import SEGMENTS

WIDE_NECK = 0.007
"""Neck radius from which a diverticulum is also in the simulated wall [m]: a 13 mm colonoscope fits into it."""

_BEND_NEAR, _BEND_SHARE = 0.015, 0.4
"""How near a bend counts [m], and how far towards its center a lesion may be, a wide sac's depth included, as a share
of its radius: where creases begin."""

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
    """Place the lesions that the spec asks for, off the folds and off each other.

    Raises:
        ValueError: A segment has no room for its lesions.
    """
    lesions = _openings(surface) if surface.spec.openings else []
    for polyp in sorted(surface.spec.polyp_list, key=lambda polyp: -polyp.diameter):
        lesions.append(_place(surface, polyp.segment, polyp, lesions, rng))
    for name in SEGMENTS:
        segment = effective_segment(surface.spec, name)
        kinds = ["wide diverticulum"] * segment.wide_diverticula
        kinds += ["diverticulum"] * (segment.diverticula - segment.wide_diverticula) + ["polyp"] * segment.polyps
        for kind in kinds:
            lesions.append(_place(surface, name, kind, lesions, rng))
    return lesions


def _openings(surface: Surface) -> list[Lesion]:
    """Place the ileocecal valve on its fold at the medial wall, the appendix orifice 28 mm below."""
    s, theta = surface.ileum
    below = min(s + 0.028, surface.curve.length - DOME_LENGTH - 0.008)
    angle = surface.medial_angle(below)
    return [Lesion("valve", s, theta, 0.011, 0.0065, 1.0), Lesion("appendix", below, angle, 0.0028, 0.005, 1.0)]


def _meets(surface: Surface, row: int, theta: float) -> bool:
    """Return whether the folds of a row reach to an angle."""
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
        return Lesion("diverticulum", s, theta, rng.uniform(*spec.wide_neck), rng.uniform(0.011, 0.014), 1.15)
    if kind == "diverticulum":
        neck = rng.uniform(*spec.diverticulum_neck)
        return Lesion(kind, s, theta, neck, rng.uniform(0.006, 0.010), rng.uniform(1.25, 1.6))
    radius = rng.uniform(*spec.polyp_radius)
    shape = "pedunculated" if rng.uniform() < 0.4 else "sessile"
    return Lesion(shape, s, theta, radius, radius * rng.uniform(0.9, 1.5), 1.0)


def _off_folds(surface: Surface, lesion: Lesion) -> bool:
    """Return whether there is no fold or rectal valve on the patch, nor the inside of a bend behind it."""
    wide = lesion.kind == "diverticulum" and lesion.size >= WIDE_NECK
    s = lesion.s + np.array([-_BEND_NEAR, 0.0, _BEND_NEAR])
    bend = surface.curve.interpolate(s, surface.curve.curvature_vector)
    towards = (bend * surface.curve.outwards(s, np.full(3, lesion.theta))).sum(1).max()
    if towards * (float(surface.lumen_radius(s)[1]) + lesion.depth * wide) > _BEND_SHARE:
        return False
    if any(abs(lesion.s - valve.s) < lesion.patch + 0.012 for valve in surface.valves):
        return False
    near = [np.abs(row.s - lesion.s).min() for k, row in enumerate(surface.rows) if _meets(surface, k, lesion.theta)]
    return all(distance >= (0.9 if wide else 0.75) * lesion.patch for distance in near)


def _apart(surface: Surface, lesion: Lesion, other: Lesion) -> bool:
    radius = float(surface.lumen_radius(np.array(lesion.s)))
    around = radius * abs(np.mod(lesion.theta - other.theta + np.pi, 2 * np.pi) - np.pi)
    return bool(np.hypot(lesion.s - other.s, around) > 1.3 * (lesion.patch + other.patch))
