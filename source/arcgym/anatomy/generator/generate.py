# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Make a colon stage of a spec."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path

import numpy as np

from arcgym.anatomy.generator.acceptance import check_course, wall_bounds
from arcgym.anatomy.generator.centerline import make_centerline
from arcgym.anatomy.generator.lesions import Lesion, place_lesions
from arcgym.anatomy.generator.posture import make_posed, repose
from arcgym.anatomy.generator.quantize import quantize
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.generator.surface import Surface
from arcgym.anatomy.generator.visual import sample_visual
from arcgym.anatomy.generator.wall import sample_wall
from arcgym.anatomy.landmarks import find_landmarks
from arcgym.anatomy.mucosa.texture import write_textures
from arcgym.anatomy.stage.types import Centerline, ColonStage
from arcgym.anatomy.validation.checks import failed
from arcgym.anatomy.validation.wall_checks import check_wall

_LOGGER = logging.getLogger(__name__)
POSTURE_TOLERANCE = 0.03
"""Largest relative difference of arc lengths between postures."""

_CENTERLINE_SPACING = 0.005
"""Distance of the points of the stage's centerline [m]."""

_OPENINGS = {"valve": "ileocecal_valve", "appendix": "appendix_orifice"}
"""Landmark of each opening of the cecum."""


class AnatomyError(ValueError):
    """No seed gave an anatomy that passes its checks."""


def make_colon(spec: ColonSpec, folder: Path) -> ColonStage:
    """Generate a colon; folded or self-touching anatomies are rejected and another seed is tried.

    Args:
        spec: Specification of the colon.
        folder: Where its two textures are written.

    Raises:
        AnatomyError: All attempts were rejected; names what failed each time.
        ValueError: A value of the spec is impossible.
    """
    rejected = []
    for attempt in range(spec.max_attempts):
        seed = spec.seed + 1000 * attempt
        try:
            surface, lesions = draw_surface(spec, seed)
        except AnatomyError as error:
            rejected.append(f"seed {seed}: {error}")
            continue
        wall = sample_wall(surface, lesions)
        problems = failed([*check_course(spec, surface), *check_wall(wall, wall_bounds(spec))])
        if not problems:
            break
        rejected.append(f"seed {seed}: " + "; ".join(str(check) for check in problems))
        _LOGGER.info("Rejected %s", rejected[-1])
    else:
        raise AnatomyError(
            f"ColonSpec '{spec.name}' gave no usable anatomy in {spec.max_attempts} attempts. Take another seed, or"
            " change acute_bends, min_bend_radius, the lengths of the segments that failed, or max_attempts:\n"
            + "\n".join(rejected)
        )
    folder.mkdir(parents=True, exist_ok=True)
    albedo, detail = write_textures(folder, spec.seed, spec.mucosa)
    openings = {_OPENINGS[lesion.kind]: lesion.s for lesion in lesions if lesion.kind in _OPENINGS}
    fine = spec.visual_rows, spec.visual_columns, spec.visual_refinements
    return ColonStage(
        name=spec.name,
        wall=wall,
        visual=quantize(sample_visual(surface, wall, lesions, *fine)),
        visual_proxy=quantize(sample_visual(surface, wall, lesions, spec.proxy_rows, spec.proxy_columns, 1)),
        centerline=_sample_centerline(surface),
        landmarks=find_landmarks(surface.curve, openings),
        material=spec.material,
        albedo_texture=albedo,
        detail_texture=detail,
        metadata=_metadata(spec, seed),
    )


def draw_surface(spec: ColonSpec, seed: int) -> tuple[Surface, list[Lesion]]:
    """Draw a colon's surface and lesions; of another posture, the course differs and nothing else.

    Raises:
        AnatomyError: The course does not fit into the other posture.
        ValueError: A segment has no room for its lesions.
    """
    rng = np.random.default_rng(seed)
    supine = replace(spec, posture="supine")
    surface = Surface(spec, make_centerline(supine, rng), rng)
    lesions = place_lesions(surface, rng)
    if spec.posture != "supine":
        posed = make_posed(spec, surface.curve, seed)
        error = float(np.abs(posed.ends / surface.curve.ends - 1.0).max())
        if error > POSTURE_TOLERANCE:
            raise AnatomyError(f"lengths of segments differ by {error:.2f} between postures")
        surface = surface.reposed(repose(surface.curve, posed))
    return surface, lesions


def _sample_centerline(surface: Surface) -> Centerline:
    curve = surface.curve
    s = np.linspace(0.0, curve.length, round(curve.length / _CENTERLINE_SPACING) + 1)
    return Centerline(
        points=curve.position(s).astype(np.float32),
        arc=s.astype(np.float32),
        radius=surface.lumen_radius(s).astype(np.float32),
        segment=curve.segment(s),
    )


def _metadata(spec: ColonSpec, seed: int) -> dict[str, str | int]:
    return {
        "patient": spec.patient,
        "provenance": "generated by arcgym.anatomy from scripts/tools/author_assets.py; no patient data",
        "licence": "BSD-3-Clause",
        "seed": seed,
    }
