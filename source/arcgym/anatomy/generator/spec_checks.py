# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Bounds of every field of a spec."""

from __future__ import annotations

from typing import TYPE_CHECKING

from arcgym.anatomy.generator.conditions import check_conditions
from arcgym.anatomy.generator.courses import SIGMOID_SHAPES, TRANSVERSE_SHAPES
from arcgym.anatomy.generator.kept_courses import KEPT_COURSES
from arcgym.anatomy.segments import SEGMENTS

if TYPE_CHECKING:
    from arcgym.anatomy.generator.spec import ColonSpec, FoldSpec, SegmentSpec

PARIS = ("Ip", "Is", "IIa")
"""Shapes of polyps that can be made."""

POSTURES = ("supine", "prone")
"""Postures that a colon can be made in."""

_RANGES = {
    "seed": (0, 2**62),
    "acute_bends": (0, 30),
    "min_bend_radius": (0.010, 0.033),
    "waviness": (0.0, 0.010),
    "inflation": (0.5, 1.3),
    "transverse_sag": (0.0, 0.25),
    "left_rise": (-0.08, 0.15),
    "right_rise": (-0.08, 0.15),
    "iliac_fossa": (0.10, 0.30),
    "jitter": (0.0, 0.02),
    "radius_variation": (0.0, 0.2),
    "clearance": (0.0, 0.1),
    "wall_thickness": (0.0005, 0.006),
    "grid.rings": (8, 1000),
    "grid.sectors": (6, 96),
    "grid.contact": (1, 12),
    "grid.visual": (1, 24),
    "min_lumen_radius": (0.004, 0.03),
    "visual_refinements": (0, 4),
    "first_attempt": (0, 1000),
    "max_attempts": (1, 100),
    "mucosa.width": (64, 4096),
    "mucosa.paleness": (0.0, 1.0),
    "mucosa.redness": (0.0, 1.0),
    "mucosa.vessels": (0.0, 2.0),
    "mucosa.stool": (0.0, 0.5),
    "mucosa.fluid": (0.0, 0.5),
    "mucosa.bubbles": (0.0, 0.5),
    "material.youngs_modulus": (1e2, 1e9),
    "material.poissons_ratio": (0.0, 0.4999),
    "material.density": (500.0, 2000.0),
}
"""Smallest and largest value of a number, by the path of its field; SI units."""

_PAIRS = {"polyp_radius": (0.001, 0.0125), "wide_neck": (0.007, 0.010), "diverticulum_neck": (0.001, 0.005)}
"""The same for both values of a pair."""

_SEGMENT_RANGES = {
    "length": (0.02, 1.5),
    "start_diameter": (0.02, 0.12),
    "middle_diameter": (0.02, 0.12),
    "diverticula": (0, 60),
    "wide_diverticula": (0, 10),
    "polyps": (0, 30),
}
"""The same for the fields of each segment."""

_FOLD_RANGES = {"spacing": (0.010, 0.10), "depth": (0.0, 1.1), "width": (0.001, 0.010), "stagger": (0.0, 1.0)}
"""The same for the fields of each segment's folds."""


def check_spec(spec: ColonSpec) -> None:
    """Check every field.

    Raises:
        ValueError: Names the field, its value and what is allowed.
    """
    for name, (low, high) in _RANGES.items():
        _check(name, _value(spec, name), low, high)
    for name, (low, high) in _PAIRS.items():
        _check_pair(name, getattr(spec, name), low, high)
    if spec.grid.visual % spec.grid.contact:
        raise ValueError(
            f"ColonSpec.grid.visual = {spec.grid.visual} must be a multiple of grid.contact = {spec.grid.contact}."
        )
    _check_choice("posture", spec.posture, POSTURES)
    check_conditions(spec)
    _check_choice("sigmoid_shape", spec.sigmoid_shape, SIGMOID_SHAPES)
    if spec.course is not None:
        _check_choice("course", spec.course, KEPT_COURSES)
    _check_choice("transverse_shape", spec.transverse_shape, TRANSVERSE_SHAPES)
    if not spec.name or "/" in spec.name:
        raise ValueError(
            f"ColonSpec.name = '{spec.name}' cannot name a folder; expected one or more letters, no slash."
        )
    missing = [name for name in SEGMENTS if name not in spec.segments]
    unknown = [name for name in spec.segments if name not in SEGMENTS]
    if missing or unknown:
        raise ValueError(f"ColonSpec.segments: missing {missing}, unknown {unknown}; expected {list(SEGMENTS)}.")
    for name, segment in spec.segments.items():
        _check_segment(f"segments['{name}']", segment, spec)
    for k, polyp in enumerate(spec.polyp_list):
        _check_choice(f"polyp_list[{k}].segment", polyp.segment, SEGMENTS)
        _check_choice(f"polyp_list[{k}].paris", polyp.paris, PARIS)
        _check(f"polyp_list[{k}].diameter", polyp.diameter, 0.002, 0.025)
    if spec.segments["rectum"].diverticula:
        raise ValueError("ColonSpec.segments['rectum'].diverticula must be 0: the rectum has no diverticula.")


def _check_segment(where: str, segment: SegmentSpec, spec: ColonSpec) -> None:
    for name, (low, high) in _SEGMENT_RANGES.items():
        _check(f"{where}.{name}", getattr(segment, name), low, high)
    wide = segment.wide_diverticula
    _check(f"{where}.diverticula (of which {wide} wide)", segment.diverticula, wide, 60)
    narrowest = 2.0 * spec.min_lumen_radius
    for name in ("start_diameter", "middle_diameter"):
        _check(f"{where}.{name} (twice min_lumen_radius is {narrowest:g})", getattr(segment, name), narrowest, 0.12)
    if segment.folds is not None:
        _check_folds(f"{where}.folds", segment.folds)


def _check_folds(where: str, folds: FoldSpec) -> None:
    for name, (low, high) in _FOLD_RANGES.items():
        _check(f"{where}.{name}", getattr(folds, name), low, high)
    if folds.spacing < 4 * folds.width:
        raise ValueError(
            f"ColonSpec.{where}.spacing = {folds.spacing:g} leaves no room between folds of half thickness"
            f" {folds.width:g}; expected {4 * folds.width:g} or more."
        )


def _value(spec: ColonSpec, path: str) -> float | None:
    value = spec
    for name in path.split("."):
        value = getattr(value, name)
    return value  # type: ignore[return-value]


def _check(name: str, value: float | None, low: float, high: float) -> None:
    if value is not None and not low <= value <= high:
        raise ValueError(f"ColonSpec.{name} = {value:g} is out of range; expected {low:g} to {high:g}.")


def _check_pair(name: str, pair: tuple[float, float], low: float, high: float) -> None:
    for value in pair:
        _check(name, value, low, high)
    if pair[0] > pair[1]:
        raise ValueError(f"ColonSpec.{name} = {pair[0]:g}, {pair[1]:g} is in the wrong order; expected small, large.")


def _check_choice(name: str, value: str, known: dict | tuple[str, ...]) -> None:
    if value not in known:
        raise ValueError(f"ColonSpec.{name} = '{value}' is unknown; expected one of {', '.join(known)}.")
