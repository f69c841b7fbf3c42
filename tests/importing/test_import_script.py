# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The whole import of surfaces by the script itself: formats, units, windings, open and closed at the rectum."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from label_volumes import RADIUS, course, write_volume
from skimage.measure import marching_cubes
from test_surfaces import write

from arcgym.anatomy import read_colon
from arcgym.anatomy.importing.volumes import read_volume

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "tools" / "import_colon.py"

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("suffix", "scale", "inside_out", "opened"),
    [
        (".stl", 1e3, True, True),
        (".obj", 1.0, False, False),
        (".vtk", 1e3, False, False),
        (".vtk", 1.0, True, True),
    ],
)
def test_surface_becomes_a_stage(suffix: str, scale: float, inside_out: bool, opened: bool, tmp_path: Path) -> None:
    grid = read_volume(write_volume(tmp_path / "tube.mha"), None, None, 0.003)
    points, faces, *_ = marching_cubes(grid.values, 0.5)
    points = grid.points(points)
    if opened:
        faces = faces[points[faces][:, :, 2].min(1) > 0.0]
    surface = write(tmp_path / f"tube{suffix}", scale * points, faces[:, ::-1] if inside_out else faces)
    out = tmp_path / "out"
    subprocess.run([sys.executable, SCRIPT, surface, out], check=True, capture_output=True)
    stage = read_colon(out / "colon.usda")
    line, length = course()
    whole = length + RADIUS * (1.0 if opened else 2.0)
    assert stage.length == pytest.approx(whole, rel=0.02)
    pole = stage.centerline.points[-1] - np.array(stage.metadata["translationAfterRotation"])
    assert np.linalg.norm(pole - line[-1]) < 2.0 * RADIUS
