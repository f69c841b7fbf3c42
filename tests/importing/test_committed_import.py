# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The committed colon, voxelised and imported again, against the truth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from arcgym.anatomy import ColonStage, read_colon
from arcgym.anatomy.importing import ImportSettings, import_to_folder
from arcgym.anatomy.importing.measures import hausdorff95, surface_samples

COLON = Path(__file__).resolve().parents[2] / "assets" / "usd" / "colon_1" / "colon.usda"
BENT = 0.08
"""Distance from the anal verge within which the importer bends the canal upright [m]."""

POLE_BOUND = 0.022
"""A caecum that is nearly a ball does not show its pole: the same along the surface is 20 mm here."""

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def truth() -> ColonStage:
    return read_colon(COLON)


@pytest.fixture(scope="module", params=["mm", "m"])
def imported(request: pytest.FixtureRequest, truth: ColonStage, tmp_path_factory: pytest.TempPathFactory) -> ColonStage:
    """The inner surface, open at the anus: once in millimetres, inside out and posterior forwards, once as it is."""
    folder = tmp_path_factory.mktemp("colon")
    points, faces = truth.visual.points, truth.visual.faces
    if request.param == "mm":
        points, faces = 1e3 * points * [-1, -1, 1], faces[:, ::-1]
    trimesh.Trimesh(points, faces, process=False).export(folder / "colon.ply")
    told = import_to_folder(folder / "colon.ply", folder / "out", ImportSettings())
    assert told["orientation"]["frame"] == ("lps" if request.param == "mm" else "ras")
    return read_colon(folder / "out" / "colon.usda")


def offset(stage: ColonStage) -> np.ndarray:
    return np.array(stage.metadata["translationAfterRotation"])


def test_length(imported: ColonStage, truth: ColonStage) -> None:
    assert imported.length == pytest.approx(truth.length, rel=0.02)


def test_surface(imported: ColonStage, truth: ColonStage) -> None:
    a = surface_samples(imported.visual.points, imported.visual.faces, 0.001)
    b = surface_samples(truth.visual.points, truth.visual.faces, 0.001) + offset(imported)
    a, b = (x[np.linalg.norm(x, axis=1) > BENT] for x in (a, b))
    assert max(hausdorff95(a, b)) < 0.0015


def test_landmarks(imported: ColonStage, truth: ColonStage) -> None:
    for name in set(truth.landmarks) & set(imported.landmarks):
        place = [
            np.array(
                [
                    np.interp(stage.landmarks[name], stage.centerline.arc, stage.centerline.points[:, k])
                    for k in range(3)
                ]
            )
            for stage in (imported, truth)
        ]
        bound = POLE_BOUND if name == "cecum_pole" else 0.015
        assert np.linalg.norm(place[0] - offset(imported) - place[1]) < bound, name
