# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Analytic solutions of beams and ropes."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_bvp


def small_deflection(force: float, length: float, rigidity: float) -> float:
    """Return the end of a clamped beam under an end load [m]: F L^3 / 3 EI (Euler-Bernoulli)."""
    return force * length**3 / (3.0 * rigidity)


def graded_deflection(force: float, length: float, parts: list[tuple[float, float]]) -> float:
    """Return the end of a clamped beam of several rigidities under an end load [m].

    The integral of F s^2 / EI(s) over the distance s from the free end (Castigliano).

    Args:
        force: Load [N].
        length: Length [m].
        parts: How far from the free end each part reaches [m], in order, and its rigidity [N m^2]; the last one reaches
            the clamp.
    """
    begin, total = 0.0, 0.0
    for end, rigidity in parts:
        end = min(end, length)
        total += force * (end**3 - begin**3) / (3.0 * rigidity)
        begin = end
    return total


def own_weight_deflection(load: float, length: float, rigidity: float) -> float:
    """Return the end of a clamped beam under a load by length [N/m] across it [m]: q L^4 / 8 EI (Euler-Bernoulli)."""
    return load * length**4 / (8.0 * rigidity)


def elastica_deflection(force: float, length: float, rigidity: float) -> float:
    """Return the end of a clamped elastica under a dead end load across its rest direction [m].

    EI theta'' = -F cos(theta), theta(0) = 0, theta'(L) = 0 (Bisshopp and Drucker 1945, Q. Appl. Math. 3).
    """
    load = force * length**2 / rigidity
    s = np.linspace(0.0, 1.0, 101)

    def slope(_: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.stack([y[1], -load * np.cos(y[0]), np.sin(y[0])])

    def ends(start: np.ndarray, end: np.ndarray) -> np.ndarray:
        return np.array([start[0], start[2], end[1]])

    guess = np.stack([0.5 * load * s, 0.5 * load * (1.0 - s), 0.2 * load * s**2])
    solution = solve_bvp(slope, ends, s, guess, tol=1.0e-8)
    if not solution.success:
        raise RuntimeError(f"The elastica at F L^2 / EI = {load:.3g} was not found: {solution.message}")
    return float(length * solution.y[2, -1])


def clamped_pinned_load(length: float, rigidity: float) -> float:
    """Return the buckling load of a column clamped at one end and guided at the other [N].

    k^2 EI with tan(kL) = kL (Euler).
    """
    return rigidity * (4.493409457909064 / length) ** 2


def capstan_ratio(friction: float, angle: float) -> float:
    """Return the ratio of the tensions on both sides of a bend: e^(mu theta) (Euler, Eytelwein)."""
    return math.exp(friction * angle)
