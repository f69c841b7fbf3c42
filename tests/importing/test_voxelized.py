# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Generated colons as label volumes with gaps, leaks, tubes and noise, imported and compared with the truth.

``pytest -m slow -s tests/importing/test_voxelized.py`` prints the figures.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from label_volumes import DIRECTIONS
from surface_distance import hausdorff95, surface_samples
from true_pole import true_pole
from voxelized import gap, noise, place, rectal_tube, small_bowel, write_voxelized

from arcgym.anatomy import read_colon
from arcgym.anatomy.importing import ImportSettings, import_to_folder

COLONS = Path(__file__).resolve().parents[2] / "assets" / "usd"
BENT = 0.11
"""Distance from the anal verge within which the importer draws the canal anew [m]."""

CASES = {
    "noise and fluid": ("colon_1", "identity", [noise, gap(0.5, 0.05, fluid=True)], []),
    "gaps": ("colon_2", "flipped_x", [gap(0.3, 0.005), gap(0.75, 0.015), gap(1.15, 0.028)], []),
    "small bowel": ("colon_3", "oblique", [small_bowel(0.7)], ["side branch"]),
    "small bowel, joined twice": ("colon_4", "permuted", [small_bowel(1.0)], ["side branch"]),
    "thread and tube": ("colon_5", "flipped_z", [gap(0.85, 0.03, thread=0.002), rectal_tube], ["rectal tube"]),
}
"""Colon, direction matrix, what is done to it, and what has to be cut off again."""

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("case", CASES)
def test_import_is_near_the_truth(case: str, tmp_path: Path) -> None:
    name, direction, edits, cut = CASES[case]
    truth = read_colon(COLONS / name / "colon.usda")
    volume = write_voxelized(truth, tmp_path / "colon.nii.gz", DIRECTIONS[direction], edits)
    report = import_to_folder(volume, tmp_path / "out", ImportSettings())
    imported = read_colon(tmp_path / "out" / "colon.usda")
    shift = np.array(imported.metadata["translationAfterRotation"])
    a = surface_samples(imported.visual.points, imported.visual.faces, 0.0005)
    b = surface_samples(truth.visual.points, truth.visual.faces, 0.0005) + shift
    surface = max(hausdorff95(*(x[np.linalg.norm(x, axis=1) > BENT] for x in (a, b))))
    marks = set(truth.landmarks) & set(imported.landmarks)
    there = {mark: place(truth, truth.landmarks[mark]) for mark in marks} | {"cecum_pole": true_pole(truth)}
    found = {mark: place(imported, imported.landmarks[mark]) - shift for mark in marks}
    away = {mark: np.linalg.norm(found[mark] - there[mark]) for mark in marks}
    worst = max(away, key=lambda mark: away[mark])
    ratio = imported.length / truth.length
    print(f"\n{case}: length {ratio - 1:+.1%}, surface {1e3 * surface:.2f} mm, {worst} {1e3 * away[worst]:.0f} mm")
    assert (
        0.94 < ratio < 1.02
    )  # the smoothed centerline cuts bends as tight as the lumen; gaps are bridged as they come
    assert surface < 0.0015
    assert away[worst] < (0.04 if worst == "cecum_pole" else 0.03), worst
    assert set(cut) <= {piece["kind"] for piece in report["cleaning"]["cut"]}
    assert [check for check in report["checks"] if not check["ok"]] == []
