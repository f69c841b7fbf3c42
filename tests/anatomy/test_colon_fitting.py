# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""From a lumen's surface to wall, contact and visual surfaces, on a bend that folds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from folded_bend import STEP, centerline, field
from scipy.spatial import cKDTree
from tiny import tiny_colon_stage

from arcgym.anatomy import read_colon, write_colon
from arcgym.anatomy.curve import Curve
from arcgym.anatomy.grid_shape import GridShape
from arcgym.anatomy.measures import flipped_normal_fraction, winds_outwards
from arcgym.anatomy.meshing.colon_fitting import FitSettings, FittedColon, fit_colon
from arcgym.anatomy.meshing.grid_surfaces import Detail
from arcgym.anatomy.meshing.mending import mend_wall
from arcgym.anatomy.meshing.triangle_surface import TriangleSurface, cut_surface
from arcgym.anatomy.stage import StageError
from arcgym.anatomy.validation.checks import failed
from arcgym.anatomy.validation.stage_checks import inspect_stage
from arcgym.anatomy.validation.wall_checks import WallBounds, check_wall

SHAPE = GridShape(rings=14)
SETTINGS = FitSettings(shape=SHAPE, lead=0.016)


@pytest.fixture(scope="module")
def surface() -> TriangleSurface:
    values, low = field(centerline())
    return cut_surface(values, low, 0.00125)


@pytest.fixture(scope="module")
def curve() -> Curve:
    """The line and a pole at the end of its dome, in eight segments of equal length."""
    line = centerline()
    ahead = (line[-1] - line[-2]) / STEP
    return Curve(np.concatenate([line, [line[-1] + 0.0155 * ahead]])[::8], np.arange(1, 9.0))


@pytest.fixture(scope="module")
def fitted(surface: TriangleSurface, curve: Curve) -> FittedColon:
    return fit_colon(surface, curve, SETTINGS)


def test_wall_is_valid_and_its_rings_stand_apart(fitted: FittedColon) -> None:
    assert failed(check_wall(fitted.wall, WallBounds(ring_distance=0.003, lumen_radius=0.007))) == []
    outer = fitted.wall.points.reshape(2, SHAPE.rings, SHAPE.sectors, 3)[1]
    assert np.linalg.norm(np.diff(outer, axis=0), axis=2).min() > 0.003


def test_contact_surface_has_the_folds(fitted: FittedColon, surface: TriangleSurface) -> None:
    """From the surface, beyond the verge, to the contact surface: 3 mm at the 95th percentile, the wall is farther."""
    inside = surface.points[surface.points[:, 1] > 0.0]
    contact = fitted.contact.points.reshape(fitted.contact.rows, -1, 3)
    dense = np.concatenate([contact, 0.5 * (contact + np.roll(contact, -1, 1))])
    off = np.percentile(cKDTree(dense.reshape(-1, 3)).query(inside)[0], 95)
    assert off < 0.003
    assert fitted.contact.rows == 13 * SHAPE.contact + 1 + 6 and fitted.contact.columns == 42


def test_contact_rows_belong_to_their_cell_of_the_wall(fitted: FittedColon) -> None:
    """Row 3 r + 1 and column 3 j + 2 lie a third of the way from ring r on and two from sector j to the next."""
    contact, sectors = fitted.contact, SHAPE.sectors
    vertex = (3 * 4 + 1) * contact.columns + 3 * 13 + 2
    carriers = [4 * sectors + 13, 5 * sectors + 13, 5 * sectors, 4 * sectors]
    assert contact.skin_indices[vertex].tolist() == carriers
    assert contact.skin_weights[vertex] == pytest.approx([2 / 9, 1 / 9, 2 / 9, 4 / 9])
    assert (
        contact.skin_weights[-1] == pytest.approx([0, 2 / 3, 1 / 3, 0], abs=1) and contact.skin_weights[-1].sum() == 1
    )


def test_contact_surface_is_closed_but_at_the_verge(fitted: FittedColon) -> None:
    faces = fitted.contact.faces()
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), 1)
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    last = (fitted.contact.rows - 1) * fitted.contact.columns
    alone = unique[uses == 1]
    assert ((alone < fitted.contact.columns) | (alone >= last)).all()
    assert winds_outwards(fitted.contact.points, faces)


def test_contact_surface_is_read_as_written(fitted: FittedColon, tmp_path: Path) -> None:
    stage = replace(tiny_colon_stage(texture_folder=tmp_path), wall=fitted.wall, contact=fitted.contact)
    read = read_colon(write_colon(stage, tmp_path / "colon.usda")).contact
    assert read is not None and read.columns == 42
    for name in ("points", "skin_indices", "skin_weights"):
        assert np.array_equal(getattr(read, name), getattr(fitted.contact, name)), name


def test_contact_surface_of_ragged_rows_is_named(fitted: FittedColon, tmp_path: Path) -> None:
    stage = replace(
        tiny_colon_stage(texture_folder=tmp_path), wall=fitted.wall, contact=replace(fitted.contact, columns=35)
    )
    with pytest.raises(StageError, match="points in 35 columns"):
        read_colon(write_colon(stage, tmp_path / "colon.usda"))


def test_visual_surfaces_face_the_lumen(fitted: FittedColon) -> None:
    for visual in (fitted.visual, fitted.visual_proxy):
        assert not winds_outwards(visual.points, visual.faces)
        assert flipped_normal_fraction(visual) < 0.002
        assert visual.skin_weights.sum(1) == pytest.approx(np.ones(len(visual.points)), abs=1e-5)
        assert visual.skin_weights.min() >= 0.0


def test_carriers_are_near_what_they_carry(fitted: FittedColon) -> None:
    anchor = np.einsum("mk,mkd->md", fitted.visual.skin_weights, fitted.wall.points[fitted.visual.skin_indices])
    tube = fitted.visual.skin_indices.max(1) < SHAPE.rings * SHAPE.sectors - 2 * SHAPE.sectors
    assert np.percentile(np.linalg.norm(fitted.visual.points - anchor, axis=1)[tube], 95) < 0.006


def test_detail_is_refined_and_shaped(surface: TriangleSurface, curve: Curve) -> None:
    """A patch of 5 mm is split twice and moved by 1 mm; all else stays."""
    middle = np.array([0.016, 0.030, 0.0])
    near = lambda points: np.linalg.norm(points - middle, axis=1) < 0.005  # noqa: E731
    detail = Detail(
        lambda points, level: near(points), lambda points: (points + 0.001 * near(points)[:, None], near(points))
    )
    plain = fit_colon(surface, curve, SETTINGS)
    shaped = fit_colon(surface, curve, SETTINGS, detail, refinements=2)
    count = near(plain.visual.points).sum()
    assert count > 5 and (shaped.visual.tint == 1).sum() > 6 * count
    assert (shaped.visual_proxy.tint == 1).sum() > 2 * near(plain.visual_proxy.points).sum()


def test_wall_narrower_than_a_head_is_widened() -> None:
    """Rings of 5 mm radius become 7.5 mm; the outer layer stays 2 mm away, the last ring's goes on along the tube."""
    angle = -np.arange(12) * np.pi / 6  # right-handed about +Y
    ring = np.stack([0.005 * np.cos(angle), 0 * angle, 0.005 * np.sin(angle)], 1)
    inner = ring + np.arange(10)[:, None, None] * [0, 0.010, 0]
    layers = np.stack([inner, inner + 0.002 * ring / 0.005])
    layers[1, -1, :, 1] += 0.002
    mended = mend_wall(layers, 0.002, 0.0075)
    assert np.linalg.norm(mended[0][:, :, [0, 2]], axis=2) == pytest.approx(0.0075, rel=1e-6)
    assert np.linalg.norm(mended[1] - mended[0], axis=2)[:-1] == pytest.approx(0.002, rel=1e-6)


def test_wall_that_stays_inverted_is_named() -> None:
    angle = np.arange(12) * np.pi / 6
    inner = np.stack([0.02 * np.cos(angle), 0 * angle, 0.02 * np.sin(angle)], 1) * np.ones((6, 1, 1))
    layers = np.stack([inner, inner * 1.1])
    with pytest.raises(ValueError, match="folds over itself at rings"):
        mend_wall(layers, 0.002, 0.0075)


def test_validation_checks_the_contact_surface(fitted: FittedColon, tmp_path: Path) -> None:
    """A contact surface moved by 1 cm is too far from the fine one; turned inside out it is wound inwards."""
    stage = replace(
        tiny_colon_stage(texture_folder=tmp_path), wall=fitted.wall, visual=fitted.visual, contact=fitted.contact
    )
    about = [check for check in inspect_stage(stage) if "contact" in check.name]
    assert len(about) == 4 and failed(about) == []
    moved = replace(fitted.contact, points=fitted.contact.points + np.float32(0.01))
    assert "distance to the fine one" in str(failed(inspect_stage(replace(stage, contact=moved))))
    flipped = fitted.contact.points.reshape(-1, 42, 3)[:, ::-1].reshape(-1, 3)
    inside_out = replace(stage, contact=replace(fitted.contact, points=flipped))
    assert "contact surface: wound outwards" in str(failed(inspect_stage(inside_out)))
