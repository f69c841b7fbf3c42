# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Wall, contact and visual surfaces of a generated colon: its field's surface, fitted like that of any lumen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arcgym.anatomy.generator.lesion_shapes import distance_to, shape_lesion, wall_bulge
from arcgym.anatomy.generator.lesions import Lesion
from arcgym.anatomy.generator.lumen_field import LEAD, FieldGrid, LumenField
from arcgym.anatomy.generator.surface import Surface
from arcgym.anatomy.meshing.colon_fitting import FitSettings, FittedColon, fit_colon
from arcgym.anatomy.meshing.grid_surfaces import Detail
from arcgym.anatomy.meshing.quantize import quantize, quantize_contact
from arcgym.anatomy.meshing.triangle_surface import cut_surface

LEG_GAP = 0.0015
"""Least distance of the walls of two legs of a bend, or of two loops [m]."""


def fit_surface(surface: Surface, lesions: Sequence[Lesion] = (), lumen: FieldGrid | None = None) -> FittedColon:
    """Fit a generated colon.

    Args:
        surface: The colon.
        lesions: Its lesions: all on the visual surfaces, wide diverticula also in the wall and where the scope touches.
        lumen: Its lumen, which :mod:`arcgym.anatomy.generator.head_room` may have widened; else as the surface has it.

    Raises:
        ValueError: Loops are joined, or the wall folds over itself.
    """
    spec, field = surface.spec, lumen_field(surface)
    grid = field.sample() if lumen is None else lumen
    settings = FitSettings(
        shape=spec.grid, thickness=spec.wall_thickness, least_radius=0.9 * spec.min_lumen_radius, lead=LEAD
    )
    fitted = fit_colon(
        cut_surface(grid.values, grid.origin, grid.spacing),
        surface.curve,
        settings,
        _detail(surface, lesions, field),
        spec.visual_refinements,
    )
    return replace(
        fitted,
        contact=quantize_contact(fitted.contact),
        visual=quantize(fitted.visual),
        visual_proxy=quantize(fitted.visual_proxy),
    )


def lumen_field(surface: Surface) -> LumenField:
    """Return the lumen of a colon as a field."""
    return LumenField(surface, 2 * surface.spec.wall_thickness + LEG_GAP)


def _detail(surface: Surface, lesions: Sequence[Lesion], field: LumenField) -> Detail:
    def near(points: np.ndarray, level: int) -> np.ndarray:
        s, theta = field.places(points)
        marked = np.zeros(len(points), bool)
        for lesion in lesions:
            share = distance_to(surface, lesion, s, theta) / lesion.patch
            marked |= (share < 1.15) if level < 2 else (share > 0.5) & (share < 0.9)
        return marked

    def shape(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        s, theta = field.places(points)
        points, tint = points.copy(), np.zeros(len(points))
        for lesion in lesions:
            on = np.flatnonzero(distance_to(surface, lesion, s, theta) < lesion.patch)
            if len(on):
                points[on], tint[on] = shape_lesion(surface, lesion, s[on], theta[on], points[on])
        return points, tint

    def touched(points: np.ndarray) -> np.ndarray:
        s, theta = field.places(points)
        return points + wall_bulge(surface, lesions, s, theta)[:, None] * surface.curve.outwards(s, theta)

    return Detail(near, shape, touched)
