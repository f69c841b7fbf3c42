# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The inner surface of a generated colon: lumen radius as a function of arc length and angle."""

from __future__ import annotations

from copy import copy

import numpy as np
from scipy.ndimage import gaussian_filter1d

from arcgym.anatomy.blending import smooth_step
from arcgym.anatomy.curve import Curve
from arcgym.anatomy.generator.centerline import base_radius
from arcgym.anatomy.generator.conditions import narrowed
from arcgym.anatomy.generator.folds import (
    TAENIAE,
    fold_height,
    haustral_bulge,
    make_fold_rows,
    make_valves,
    valve_height,
)
from arcgym.anatomy.generator.spec import ColonSpec

DOME_LENGTH = 0.030
"""Length over which the cecum closes [m]."""

SEAM_MARGIN = 0.7
"""Least angle from a lesion's middle to the texture's seam [rad]."""

_MEDIAL = np.array([-0.8, -0.6, 0.0])
"""Direction from the cecum to the ileum: the patient's left and back."""

_ILEUM = 0.004
"""Where the ileum enters, above the beginning of the cecum [m]."""


class Surface:
    """Radial surface about a centerline, from which :mod:`arcgym.anatomy.generator.lumen_field` makes the lumen."""

    def __init__(self, spec: ColonSpec, curve: Curve, rng: np.random.Generator) -> None:
        """Draw everything random: radius, taeniae, folds and valves."""
        self.spec, self.curve = spec, curve
        self.mean_radius = _vary_radius(spec, curve, rng)
        self.taenia = rng.uniform(0, 2 * np.pi)
        self.rows = make_fold_rows(spec, curve, rng)
        self.valves = make_valves(curve, rng)
        s = curve.bounds("cecum")[0] + _ILEUM
        self.ileum = s, self.medial_angle(s)
        if spec.openings:
            self._put_fold_at(*self.ileum)

    def medial_angle(self, s: float) -> float:
        """Return the angle of the medial wall [rad], kept off the seam of the texture."""
        _, normal, binormal = self.curve.frame(np.array(s))
        theta = float(np.arctan2(binormal @ _MEDIAL, normal @ _MEDIAL)) % (2 * np.pi)
        return float(np.clip(theta, SEAM_MARGIN, 2 * np.pi - SEAM_MARGIN))

    def _put_fold_at(self, s: float, theta: float) -> None:
        """Move the nearest fold to a place: the ileocecal valve sits on one."""
        row = self.rows[int(self.sector(np.array([theta]))[0][0])]
        row.s[np.abs(row.s - s).argmin()] = s

    def reposed(self, curve: Curve) -> Surface:
        """Return the surface along another course of the same length, see :mod:`arcgym.anatomy.generator.posture`."""
        surface = copy(self)
        surface.curve = curve
        return surface

    def lumen_radius(self, s: np.ndarray) -> np.ndarray:
        """Return the mean radius between folds at ``s`` [m], without the dome of the cecum."""
        return np.interp(s, self.curve.s, self.mean_radius)

    def dome(self, s: np.ndarray) -> np.ndarray:
        """Return the share of the radius that the dome of the cecum leaves, a quarter of an ellipse."""
        close = np.clip((self.curve.length - s) / DOME_LENGTH, 0.0, 1.0)
        return np.sqrt(close * (2.0 - close))

    def radius(self, s: np.ndarray, theta: np.ndarray, crease: np.ndarray | None = None) -> np.ndarray:
        """Return the distance from centerline to wall [m].

        Args:
            s: Arc length [m].
            theta: Angle around the lumen [rad], same shape.
            crease: How far each place is a crease on the inside of a bend, 0 to 1, same shape: folds and haustra fade
                there.
        """
        shape = s.shape
        s, theta = s.ravel(), theta.ravel()
        mean = self.lumen_radius(s)
        folds = self._folds(s, theta, mean) + _undulation(s, theta)
        for valve in self.valves:
            folds = folds - valve_height(valve, s, theta)
        radius = mean + (folds if crease is None else (1.0 - crease.ravel()) * folds)
        least = np.minimum(self.spec.min_lumen_radius, mean)
        return (np.maximum(radius, least) * self.dome(s)).reshape(shape)

    def sector(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return between which taeniae an angle lies (0 to 2), and the angle from the middle between them [rad]."""
        angle = np.mod(theta - self.taenia, 2 * np.pi)
        sector = np.minimum((angle * TAENIAE / (2 * np.pi)).astype(int), TAENIAE - 1)
        return sector, angle - (sector + 0.5) * 2 * np.pi / TAENIAE

    def _folds(self, s: np.ndarray, theta: np.ndarray, mean: np.ndarray) -> np.ndarray:
        """Return the change of radius [m] by taeniae, haustra and folds; none in the rectum."""
        start = self.curve.bounds("sigmoid")[0]
        on = smooth_step(start - 0.015, start + 0.02, s)
        sector, phi = self.sector(theta)
        drawn_in = 1.0 + 0.05 * on * np.cos(TAENIAE * phi)
        chord = mean * np.cos(np.pi / TAENIAE) / np.maximum(np.cos(phi), 0.5)
        reach = mean - chord + 0.10 * mean * np.clip(np.cos(1.4 * phi), 0.0, 1.0)
        bulge, height = np.zeros_like(s), np.zeros_like(s)
        for k, row in enumerate(self.rows):
            here = sector == k
            bulge[here] = haustral_bulge(row, s[here], phi[here])
            height[here] = fold_height(row, s[here], phi[here])
        return mean * (drawn_in * (1.0 + bulge * on) - 1.0) - height * reach * on


def _vary_radius(spec: ColonSpec, curve: Curve, rng: np.random.Generator) -> np.ndarray:
    """Return the smoothed mean radius at the curve's samples [m], with slow random variation."""
    nominal = sum(segment.length for segment in spec.segments.values())
    radius = base_radius(spec, curve.s * nominal / curve.length)
    radius = gaussian_filter1d(radius, 4.0, mode="nearest")
    noise = gaussian_filter1d(rng.normal(size=len(curve.s)), 12.0, mode="nearest")
    return narrowed(spec, curve, radius * (1.0 + spec.radius_variation * noise / noise.std()))


def _undulation(s: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Return fine unevenness of the mucosa [m], about 0.3 mm."""
    broad = np.sin(900 * s + 2.1 * np.sin(3 * theta)) * np.sin(5 * theta + 310 * s)
    fine = np.sin(1510 * s + 7 * theta) * np.cos(377 * s - 4 * theta)
    return 0.00035 * (broad + 0.8 * fine)
