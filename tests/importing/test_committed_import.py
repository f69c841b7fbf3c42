# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Every committed colon, written as a surface and imported again, against the truth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from surface_distance import hausdorff95, surface_samples
from test_surfaces import write
from true_pole import true_pole

from arcgym.anatomy import ColonStage, read_colon
from arcgym.anatomy.importing import ImportSettings, import_to_folder

COLONS = Path(__file__).resolve().parents[2] / "assets" / "usd"
BENT = 0.11
"""Distance from the anal verge within which the importer draws the canal anew [m]."""

SAMPLES = 0.0005
"""Distance of the samples of both surfaces [m]; adds less than half of it to the distance between them."""

KINDS = {
    "colon_1": (".ply", "mm", True),
    "colon_2": (".stl", "m", False),
    "colon_3": (".vtk", "mm", True),
    "colon_4": (".obj", "mm", False),
    "colon_5": (".glb", "m", True),
}
"""Format, unit, and whether a colon is turned inside out; in millimeters its axes are left, posterior, cranial."""

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", params=KINDS)
def pair(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[ColonStage, ColonStage]:
    """Return a committed colon, and what its inner surface, open at the anus, was imported to."""
    truth = read_colon(COLONS / request.param / "colon.usda")
    suffix, unit, inside_out = KINDS[request.param]
    points, faces = truth.visual.points.astype(float), truth.visual.faces
    points = 1e3 * points * [-1, -1, 1] if unit == "mm" else points
    folder = tmp_path_factory.mktemp(request.param)
    surface = write(folder / f"colon{suffix}", points, faces[:, ::-1] if inside_out else faces)
    report = import_to_folder(surface, folder / "out", ImportSettings())
    assert report["input"]["units"] == unit
    assert report["orientation"]["frame"] == ("lps" if unit == "mm" else "ras")
    assert [check for check in report["checks"] if not check["ok"]] == []
    return truth, read_colon(folder / "out" / "colon.usda")


def offset(stage: ColonStage) -> np.ndarray:
    return np.array(stage.metadata["translationAfterRotation"])


def test_length(pair: tuple[ColonStage, ColonStage]) -> None:
    """The importer's smoothing takes about 2.5 % off bends as tight as the lumen; the bound is what is reached."""
    truth, imported = pair
    assert 0.94 < imported.length / truth.length < 1.01


def test_surface(pair: tuple[ColonStage, ColonStage]) -> None:
    truth, imported = pair
    a = surface_samples(imported.visual.points, imported.visual.faces, SAMPLES)
    b = surface_samples(truth.visual.points, truth.visual.faces, SAMPLES) + offset(imported)
    a, b = (x[np.linalg.norm(x, axis=1) > BENT] for x in (a, b))
    assert max(hausdorff95(a, b)) < 0.0015


def test_landmarks(pair: tuple[ColonStage, ColonStage]) -> None:
    truth, imported = pair
    for name in sorted(set(truth.landmarks) & set(imported.landmarks)):
        there = true_pole(truth) if name == "cecum_pole" else place(truth, name)
        away = place(imported, name) - offset(imported) - there
        assert np.linalg.norm(away) < 0.025, name


def place(stage: ColonStage, landmark: str) -> np.ndarray:
    """Return the position of a landmark [m]."""
    line = stage.centerline
    return np.array([np.interp(stage.landmarks[landmark], line.arc, line.points[:, k]) for k in range(3)])
