# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Make a colon stage of a spec."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from arcgym.anatomy.generator.acceptance import check_course, wall_bounds
from arcgym.anatomy.generator.centerline import make_centerline
from arcgym.anatomy.generator.fitting import fit_surface, lumen_field
from arcgym.anatomy.generator.head_room import fit_with_room
from arcgym.anatomy.generator.lesions import Lesion, place_lesions
from arcgym.anatomy.generator.posture import make_posed, repose
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.generator.surface import Surface
from arcgym.anatomy.landmarks import find_landmarks
from arcgym.anatomy.meshing.colon_fitting import FittedColon
from arcgym.anatomy.mucosa.texture import write_textures
from arcgym.anatomy.stage.types import ColonStage
from arcgym.anatomy.validation.checks import failed
from arcgym.anatomy.validation.wall_checks import check_wall

_LOGGER = logging.getLogger(__name__)
GENERATOR_VERSION = 4
"""The same spec and version give the same stage, on every processor."""

POSTURE_TOLERANCE = 0.03
"""Largest relative difference of arc lengths between postures."""

_OPENINGS = {"valve": "ileocecal_valve", "appendix": "appendix_orifice"}
"""Landmark of each opening of the cecum."""


class AnatomyError(ValueError):
    """No attempt gave an anatomy that passes its checks."""


def make_colon(spec: ColonSpec, folder: Path) -> ColonStage:
    """Generate a colon; anatomies that are not as the spec asks are rejected, and others drawn from the same seed.

    Args:
        spec: Specification of the colon.
        folder: Where its two textures are written.

    Raises:
        AnatomyError: All attempts were rejected; names what failed each time.
        ValueError: A value of the spec is impossible.
    """
    rejected = []
    for attempt in range(spec.first_attempt, spec.first_attempt + spec.max_attempts):
        try:
            drawn = draw_colon(spec, attempt)
        except AnatomyError as error:
            rejected.append(f"attempt {attempt}: {error}")
            _LOGGER.info("Rejected %s", rejected[-1])
            continue
        return _stage(spec, drawn, attempt, folder)
    raise AnatomyError(
        f"ColonSpec '{spec.name}' gave no usable anatomy in {spec.max_attempts} attempts. Take another seed, or"
        " change acute_bends, min_bend_radius, the lengths of the segments that failed, or max_attempts:\n"
        + "\n".join(rejected)
    )


@dataclass(frozen=True)
class DrawnColon:
    """One draw of a colon, as its spec asks."""

    surface: Surface
    """Course, radius and folds."""
    lesions: list[Lesion]
    """Polyps, diverticula and openings."""
    fitted: FittedColon
    """Wall and surfaces."""
    widened: float
    """Volume that was added to the lumen so that a stiff head passes [m^3]."""


def draw_colon(spec: ColonSpec, attempt: int) -> DrawnColon:
    """Draw and fit one anatomy.

    Raises:
        AnatomyError: It is not as the spec asks, or has no room for a stiff head or for its lesions; says in what.
    """
    surface, lesions = draw_surface(spec, attempt)
    _require([] if spec.posture != "supine" else failed(check_course(spec, surface)))
    lumen = lumen_field(surface).sample()
    try:
        fitted = fit_surface(surface, lesions, lumen)
        _require(failed(check_wall(fitted.wall, wall_bounds(spec))))
        fitted, added = fit_with_room(surface, lesions, lumen, fitted) if spec.head_room else (fitted, 0.0)
    except AnatomyError:
        raise
    except ValueError as error:
        raise AnatomyError(str(error)) from error
    _require(failed(check_wall(fitted.wall, wall_bounds(spec))) if added else [])
    return DrawnColon(surface, lesions, fitted, added)


def draw_surface(spec: ColonSpec, attempt: int = 0) -> tuple[Surface, list[Lesion]]:
    """Draw a colon's surface and lesions; of another posture, the course differs and nothing else.

    Args:
        spec: Specification of the colon.
        attempt: Number of the draw from the spec's seed.

    Raises:
        AnatomyError: The course does not fit into the other posture, or a segment has no room for its lesions.
    """
    rng = np.random.default_rng([spec.seed, attempt])
    supine = replace(spec, posture="supine")
    surface = Surface(spec, make_centerline(supine, rng), rng)
    try:
        lesions = place_lesions(surface, rng)
    except ValueError as crowded:  # the folds and bends of another draw may leave room
        raise AnatomyError(str(crowded)) from crowded
    if spec.posture != "supine":
        _require(failed(check_course(spec, surface)))
        posed = make_posed(spec, surface.curve, [spec.seed, attempt])
        error = float(np.abs(posed.ends / surface.curve.ends - 1.0).max())
        if error > POSTURE_TOLERANCE:
            raise AnatomyError(f"lengths of segments differ by {error:.2f} between postures")
        surface = surface.reposed(repose(surface.curve, posed))
    return surface, lesions


def _require(problems: list) -> None:
    if problems:
        raise AnatomyError("; ".join(str(check) for check in problems))


def _stage(spec: ColonSpec, drawn: DrawnColon, attempt: int, folder: Path) -> ColonStage:
    fitted = drawn.fitted
    folder.mkdir(parents=True, exist_ok=True)
    albedo, detail = write_textures(folder, spec.seed, spec.mucosa)
    openings = {_OPENINGS[lesion.kind]: lesion.s for lesion in drawn.lesions if lesion.kind in _OPENINGS}
    return ColonStage(
        name=spec.name,
        wall=fitted.wall,
        visual=fitted.visual,
        visual_proxy=fitted.visual_proxy,
        centerline=fitted.centerline,
        landmarks=find_landmarks(drawn.surface.curve, openings),
        material=spec.material,
        albedo_texture=albedo,
        detail_texture=detail,
        metadata={
            "patient": spec.patient,
            "provenance": "generated by arcgym.anatomy from scripts/tools/author_assets.py; no patient data",
            "licence": "BSD-3-Clause",
            "seed": spec.seed,
            "attempt": attempt,
            "generator": GENERATOR_VERSION,
        }
        | ({"widened_ml": round(1e6 * drawn.widened, 1)} if drawn.widened else {}),
        contact=fitted.contact,
    )
