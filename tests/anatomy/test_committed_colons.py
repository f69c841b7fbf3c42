# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The committed colons: valid, anatomically right, and what the generator makes."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import Usd, UsdValidation
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from welded import welded

from arcgym.anatomy import ColonStage, inner_faces, read_colon, write_colon
from arcgym.anatomy.generator.generate import GENERATOR_VERSION, make_colon
from arcgym.anatomy.generator.patients import PATIENTS
from arcgym.anatomy.stage.types import ContactSurface, VisualMesh
from arcgym.anatomy.validation.checks import failed
from arcgym.anatomy.validation.stage_checks import inspect_stage

ASSETS = Path(__file__).resolve().parents[2] / "assets" / "usd"


@pytest.fixture(scope="module")
def colon_1() -> ColonStage:
    return read_colon(ASSETS / "colon_1" / "colon.usda")


def carried(points: np.ndarray, mesh: ContactSurface | VisualMesh) -> np.ndarray:
    """Return where the wall carries the vertices of a mesh: on a cell's edge, rounding decides which cell it is."""
    return np.einsum("mk,mkd->md", mesh.skin_weights, points[mesh.skin_indices])


@pytest.mark.parametrize(
    "name", ["colon_1", *(pytest.param(name, marks=pytest.mark.slow) for name in PATIENTS if name != "colon_1")]
)
def test_committed_colon_is_what_the_generator_makes(name: str, tmp_path: Path) -> None:
    kept = read_colon(ASSETS / name / "colon.usda")
    made = read_colon(write_colon(make_colon(PATIENTS[name](), tmp_path), tmp_path / "colon.usda"))
    for part in ("wall", "contact", "visual", "visual_proxy", "centerline"):
        for item in fields(getattr(made, part)):
            a, b = getattr(getattr(made, part), item.name), getattr(getattr(kept, part), item.name)
            assert item.name.startswith("skin_") or np.allclose(a, b, atol=1e-5), f"{part}.{item.name}"
    for part in ("contact", "visual", "visual_proxy"):
        a, b = (carried(stage.wall.points, getattr(stage, part)) for stage in (made, kept))
        assert np.allclose(a, b, atol=1e-5), part
    for texture in ("albedo_texture", "detail_texture"):
        a, b = (np.asarray(Image.open(getattr(stage, texture)), int) for stage in (made, kept))
        assert np.abs(a - b).mean() < 0.5, texture
    assert made.landmarks == pytest.approx(kept.landmarks)
    assert made.metadata == kept.metadata | {"generator": GENERATOR_VERSION}


def test_all_checks_pass(colon_1: ColonStage) -> None:
    assert failed(inspect_stage(colon_1)) == []


def test_usd_validators_find_nothing() -> None:
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    errors = context.Validate(Usd.Stage.Open(str(ASSETS / "colon_1" / "colon.usda")))
    assert [error.GetMessage() for error in errors] == []


def test_descending_colon_is_on_the_patients_left(colon_1: ColonStage) -> None:
    """The world is right-handed, +X the patient's right, +Y anterior, +Z cranial."""
    side = {name: colon_1.wall.points[colon_1.segment_nodes(name), 0].mean() for name in ("descending", "ascending")}
    assert side["descending"] < -0.1 and side["ascending"] > 0.1
    assert np.cross([1, 0, 0], [0, 1, 0]).tolist() == [0, 0, 1]


def test_the_left_flexure_is_the_higher_one(colon_1: ColonStage) -> None:
    top = {name: colon_1.wall.points[colon_1.segment_nodes(name), 2].max() for name in ("splenic", "hepatic")}
    assert top["splenic"] > top["hepatic"] + 0.02


def test_segment_lengths_are_the_patients(colon_1: ColonStage) -> None:
    length = {name: end - start for name, (start, end) in colon_1.segment_bounds().items()}
    assert length["sigmoid"] == pytest.approx(0.55, abs=0.03)
    assert colon_1.length == pytest.approx(1.7, abs=0.1)


def test_twelve_diverticula_in_the_descending_colon(colon_1: ColonStage) -> None:
    """Each sac is one connected patch of dark tint."""
    visual = colon_1.visual
    dark = visual.tint < -0.5
    faces = welded(visual)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    edges = edges[dark[edges].all(1)]
    graph = coo_array((np.ones(len(edges)), edges.T), shape=(len(dark), len(dark)))
    labels = connected_components(graph, directed=False)[1]
    carriers = visual.skin_indices[dark]
    assert len(np.unique(labels[np.unique(edges)])) == 12
    assert (colon_1.wall.segment[carriers] == 2).mean() > 0.95


def test_ends_are_fixed_and_the_sigmoid_is_free(colon_1: ColonStage) -> None:
    wall = colon_1.wall
    assert set(wall.anchor[wall.segment == 1]) == {0}
    assert set(wall.anchor[(wall.segment == 2) & (wall.layer == 1)]) == {1}
    assert set(wall.anchor[wall.ring < 3]) == {2} and set(wall.anchor[wall.ring >= wall.num_rings - 2]) == {2}
    assert set(wall.anchor[(wall.layer == 0) & (wall.anchor != 2)]) == {0}


def test_inner_wall_is_closed_at_the_blind_end(colon_1: ColonStage) -> None:
    """The only open edges of the lumen side are those of the first ring."""
    faces = inner_faces(colon_1.wall.tets, colon_1.wall.layer)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), 1)
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    open_edges = unique[uses == 1]
    assert len(open_edges) == 14
    assert set(colon_1.wall.ring[open_edges].ravel()) == {0}
