# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How well a colon is distended, and how a spastic or diverticular sigmoid differs from a relaxed one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from arcgym.anatomy.blending import smooth_step
from arcgym.anatomy.segments import SEGMENTS

if TYPE_CHECKING:
    from arcgym.anatomy.curve import Curve
    from arcgym.anatomy.generator.spec import ColonSpec, SegmentSpec

SIGMOID_STATES = ("relaxed", "spastic", "diverticular")
"""States of the sigmoid: spastic, contracted to rings one behind the other; diverticular, its muscle thick and
shortened to close, deep folds (myochosis), and with diverticula."""

_SPASTIC = {"width": 0.70, "spacing": 0.016, "depth": 0.95, "fold_width": 0.0026, "stagger": 0.0}
_DIVERTICULAR = {"width": 0.80, "spacing": 0.017, "depth": 0.85, "fold_width": 0.0034, "stagger": 0.5}
"""Diameter over the spec's, and the folds; our choices after descriptions (myochosis: Morson, Gut 1963)."""

_DIVERTICULA = 12
"""Diverticula of a diverticular sigmoid at least; 14 is the mean of people who have any (Peery et al., CGH 2016)."""


def effective_segment(spec: ColonSpec, name: str) -> SegmentSpec:
    """Return a segment of a spec, distended and contracted as the spec says."""
    segment = spec.segments[name]
    width = spec.inflation
    if name == "sigmoid" and spec.sigmoid_state != "relaxed" and segment.folds is not None:
        state = _SPASTIC if spec.sigmoid_state == "spastic" else _DIVERTICULAR
        width *= state["width"]
        folds = replace(
            segment.folds,
            spacing=state["spacing"],
            depth=state["depth"],
            width=state["fold_width"],
            stagger=state["stagger"],
        )
        count = max(segment.diverticula, _DIVERTICULA) if spec.sigmoid_state == "diverticular" else segment.diverticula
        segment = replace(segment, folds=folds, diverticula=count)
    least = 2.0 * spec.min_lumen_radius
    return replace(
        segment,
        start_diameter=max(width * segment.start_diameter, least),
        middle_diameter=max(width * segment.middle_diameter, least),
    )


def narrowed(spec: ColonSpec, curve: Curve, radius: np.ndarray) -> np.ndarray:
    """Return the lumen radius at a curve's samples [m], shape (n,), narrowed where the spec has collapsed stretches."""
    out = radius.copy()
    for stretch in spec.collapsed:
        start, end = curve.bounds(stretch.segment)
        middle = start + stretch.position * (end - start)
        way = np.abs(curve.s - middle)
        ramp = min(0.25 * stretch.length, 0.020)
        share = 1.0 - smooth_step(0.5 * stretch.length - ramp, 0.5 * stretch.length + ramp, way)
        out = np.minimum(out, out + share * (0.5 * stretch.diameter - out))
    return out


def check_conditions(spec: ColonSpec) -> None:
    """Check state and collapsed stretches.

    Raises:
        ValueError: Names the field, its value and what is allowed.
    """
    if spec.sigmoid_state not in SIGMOID_STATES:
        raise ValueError(
            f"ColonSpec.sigmoid_state = '{spec.sigmoid_state}' is unknown; expected one of {', '.join(SIGMOID_STATES)}."
        )
    for k, stretch in enumerate(spec.collapsed):
        where = f"ColonSpec.collapsed[{k}]"
        if stretch.segment not in SEGMENTS:
            raise ValueError(
                f"{where}.segment = '{stretch.segment}' is unknown; expected one of {', '.join(SEGMENTS)}."
            )
        for name, low, high in (("position", 0.0, 1.0), ("length", 0.02, 0.4), ("diameter", 0.015, 0.06)):
            value = getattr(stretch, name)
            if not low <= value <= high:
                raise ValueError(f"{where}.{name} = {value:g} is out of range; expected {low:g} to {high:g}.")
