# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The generator's parts, on arithmetic that a reader can redo."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tiny import tiny_colon_stage

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.generator.generate import AnatomyError, make_colon
from arcgym.anatomy.generator.spec import ColonSpec, default_segments
from arcgym.anatomy.measures import tet_quality
from arcgym.anatomy.meshing.refine import refine
from arcgym.anatomy.meshing.surface_grid import skin_to_rings
from arcgym.anatomy.meshing.wall import polygon_triangles
from arcgym.anatomy.mucosa.texture import make_textures
from arcgym.anatomy.validation.checks import Check
from arcgym.anatomy.validation.wall_checks import loop_gap, ring_radii


def test_spec_names_the_value_out_of_range() -> None:
    with pytest.raises(ValueError, match=r"ColonSpec.wall_thickness = 0.05 is out of range; expected 0.0005 to 0.006"):
        ColonSpec(wall_thickness=0.05)


def test_spec_names_a_missing_segment() -> None:
    segments = default_segments()
    del segments["cecum"]
    with pytest.raises(ValueError, match=r"missing \['cecum'\]"):
        ColonSpec(segments=segments)


def test_unknown_sigmoid_shape_lists_the_known(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="'knot' is unknown; expected one of plain, angulated"):
        make_colon(ColonSpec(sigmoid_shape="knot"), tmp_path)


@pytest.mark.slow
def test_touching_loops_are_rejected(tmp_path: Path) -> None:
    with pytest.raises(AnatomyError, match="attempt 0: .*gap between loops"):
        make_colon(replace(ColonSpec(), clearance=0.06, max_attempts=1), tmp_path)
    assert not list(tmp_path.iterdir())


def test_frames_of_a_circle() -> None:
    """On a circle of 0.1 m in the XY plane the curvature is 10/m and an untwisted normal keeps its angle."""
    angle = np.linspace(0, np.pi, 100)
    points = 0.1 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    curve = Curve(points, np.linspace(0, np.pi * 0.1, 9)[1:])
    tangent, normal, binormal = curve.frame(np.array([0.05 * np.pi]))
    assert curve.length == pytest.approx(0.1 * np.pi, rel=1e-5)
    assert np.median(curve.curvature) == pytest.approx(10.0, rel=1e-3)
    assert tangent[0] == pytest.approx([-1, 0, 0], abs=1e-4)
    assert np.cross(normal[0], binormal[0]) == pytest.approx(tangent[0], abs=1e-6)
    assert abs(normal[0, 2]) == pytest.approx(1.0, abs=1e-4)


def test_regular_tetrahedron_has_quality_one() -> None:
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], float)
    quality = tet_quality(corners, np.array([[0, 1, 2, 3], [1, 0, 2, 3]]))
    assert sorted(quality) == pytest.approx([-1.0, 1.0])


def test_ring_radius_is_that_of_the_inscribed_circle() -> None:
    assert ring_radii(tiny_colon_stage().wall) == pytest.approx(0.020 * np.cos(np.pi / 8), rel=1e-5)


def test_straight_tube_has_no_other_loop_within_reach() -> None:
    assert loop_gap(tiny_colon_stage().wall) == 0.05


def test_gap_of_a_horseshoe() -> None:
    """A turn of 180 deg over 0.2 m has a radius of 63.7 mm, its inner wall one of 63.7 - 22 = 41.7 mm.

    Other loops begin beyond 1.7 x 44 = 75 mm, at 6 rings of 12.5 mm, an angle of 1.178 rad: 2 x 41.7 sin(0.589) = 46.3.
    """
    assert loop_gap(tiny_colon_stage(bend=np.pi, capped=False).wall) == pytest.approx(0.0463, abs=0.0002)


def test_gap_of_a_closed_ring() -> None:
    ring = tiny_colon_stage(length=0.6, radius=0.01, rings=60, bend=2 * np.pi)
    assert loop_gap(ring.wall) < 0.003


def test_skin_weights_halfway_between_rings_and_sectors() -> None:
    indices, weights = skin_to_rings(np.array([0.15]), np.array([np.pi / 4]), np.array([0.0, 0.1, 0.2]), sectors=4)
    assert sorted(indices[0]) == [4, 5, 8, 9]
    assert weights[0] == pytest.approx([0.25] * 4)


def test_refinement_leaves_no_hanging_vertex() -> None:
    """Splitting one of two triangles into four halves the other: 4 + 2 faces, 4 + 3 vertices, same area."""
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    fine, faces = refine(points, np.array([[0, 1, 2], [0, 2, 3]]), np.array([True, False]))
    (a, b, c) = (fine[faces[:, k]] for k in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert len(faces) == 6 and len(fine) == 7
    assert (area > 0).all() and area.sum() == pytest.approx(1.0)


def test_polygon_triangles_cover_the_polygon() -> None:
    angle = np.arange(12) * np.pi / 6
    x, y = np.cos(angle), np.sin(angle)
    a, b, c = polygon_triangles(12).T
    area = 0.5 * np.abs((x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a]))
    assert area.sum() == pytest.approx(12 * 0.5 * np.sin(np.pi / 6))


def test_textures_are_periodic_and_repeatable() -> None:
    albedo, detail = make_textures(0, width=128, height=256)
    again, _ = make_textures(0, width=128, height=256)
    across_seam = np.abs(albedo[0].astype(int) - albedo[-1]).mean()
    inside = np.abs(albedo[100].astype(int) - albedo[101]).mean()
    assert np.array_equal(albedo, again)
    assert detail.shape == (256, 128, 4)
    assert across_seam < 2 * inside


def test_a_figure_that_is_not_finite_fails() -> None:
    assert not Check("gap", float("nan"), 0.0, at_least=True).ok
    assert Check("gap", 0.0, 0.0, at_least=True).ok
