# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Semilunar folds between the taeniae and the transverse folds (Houston's valves) of the rectum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.generator.conditions import effective_segment
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.segments import SEGMENTS

TAENIAE = 3
"""Longitudinal muscle bands of the colon; the rectum has a complete coat instead."""

_CREST = 1.35
"""Height of a crest's profile before it is scaled to 1."""


@dataclass(frozen=True)
class FoldRow:
    """The folds between two taeniae, in order along the colon; every field has shape (n,)."""

    s: np.ndarray
    """Arc length of the crest at mid-row [m]."""
    depth: np.ndarray
    """Depth as a share of the way to the chord between the taeniae."""
    width: np.ndarray
    """Half thickness of the crest [m]."""
    tilt: np.ndarray
    """Advance of the crest along the colon per radian around it [m/rad]."""
    shift: np.ndarray
    """Angle by which the crest's highest point is off mid-row [rad]."""


@dataclass(frozen=True)
class Valve:
    """One transverse fold of the rectum."""

    s: float
    """Arc length of its middle [m]."""
    theta: float
    """Side it stands on [rad]."""
    depth: float
    """How far it reaches into the lumen [m]."""
    width: float
    """Half thickness [m]."""


def make_fold_rows(spec: ColonSpec, curve: Curve, rng: np.random.Generator) -> list[FoldRow]:
    """Place the folds of the three rows from the sigmoid to the cecum."""
    return [_make_row(spec, curve, rng, row) for row in range(TAENIAE)]


def _make_row(spec: ColonSpec, curve: Curve, rng: np.random.Generator, row: int) -> FoldRow:
    folds: list[tuple[float, float, float, float, float]] = []
    kinds = [effective_segment(spec, name).folds for name in SEGMENTS]
    s = curve.bounds("sigmoid")[0] - 0.004
    while s < curve.length - 0.02:
        kind = kinds[int(curve.segment(np.array(s)))]
        if kind is None:
            s += 0.01
            continue
        crest = s + row / TAENIAE * kind.spacing * kind.stagger + rng.normal(0, 0.08 * kind.spacing)
        depth, width = kind.depth * rng.uniform(0.65, 1.15), kind.width * rng.uniform(0.8, 1.3)
        folds.append((crest, depth, width, rng.normal(0, 0.003), 0.5 * rng.normal(0, 0.12)))
        s += kind.spacing * rng.uniform(0.85, 1.15)
    return FoldRow(*(np.array(column) for column in zip(*sorted(folds), strict=True)))


def make_valves(curve: Curve, rng: np.random.Generator) -> list[Valve]:
    """Place the three Houston valves: left, right, left; the middle one (Kohlrausch's) is the largest."""
    start, end = curve.bounds("rectum")
    side = np.pi + rng.normal(0, 0.3)
    shape = ((0.42, 0.0105, 0.0030), (0.62, 0.0145, 0.0032), (0.84, 0.0100, 0.0028))
    return [
        Valve(start + share * (end - start), side + k * np.pi + rng.normal(0, 0.15), depth, width)
        for k, (share, depth, width) in enumerate(shape)
    ]


def fold_height(row: FoldRow, s: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Return the fold depth (share of the way to the chord) at arc length ``s``, ``phi`` from mid-row, shape (n,).

    The crest is flat on top: a Gaussian would alias into teeth on rings half a crest apart.
    """
    height = np.zeros_like(s)
    after = np.searchsorted(row.s, s)
    for near in (after - 1, after):
        k = np.clip(near, 0, len(row.s) - 1)
        x = np.abs(s - _crest(row, k, phi)) / row.width[k]
        profile = (np.exp(-0.5 * x**3) + 0.35 * np.exp(-x / 2.6)) / _CREST
        height = np.maximum(height, row.depth[k] * profile)
    return height


def _crest(row: FoldRow, k: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Return the arc length of crest ``k`` at ``phi`` [m]: tilted and bowed, as real folds are."""
    bow = 0.0024 * (np.cos(1.5 * (phi - row.shift[k])) - 0.6)
    return row.s[k] + row.tilt[k] * phi + bow


def haustral_bulge(row: FoldRow, s: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Return the outward bulge between two folds as a share of the radius, up to 0.1, shape (n,)."""
    k = np.clip(np.searchsorted(row.s, s), 1, len(row.s) - 1)
    share = np.clip((s - row.s[k - 1]) / np.maximum(row.s[k] - row.s[k - 1], 1e-6), 0.0, 1.0)
    return 0.10 * np.sin(np.pi * share) ** 0.8 * np.clip(np.cos(1.5 * phi), 0.0, 1.0)


def valve_height(valve: Valve, s: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Return how far a rectal valve reaches into the lumen [m]: a half ring, bowed upwards at its ends."""
    angle = np.mod(theta - valve.theta + np.pi, 2 * np.pi) - np.pi
    around = np.cos(np.clip(angle / 2.1, -1, 1) * np.pi / 2) ** 0.7
    x = np.abs(s - valve.s - 0.0025 * (1 - np.cos(angle))) / valve.width
    return valve.depth * around * np.exp(-0.5 * x**2.2)
