# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A tube of known course, imported from label volumes and surfaces."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from label_volumes import DIRECTIONS, RADIUS, course, write_volume
from scipy.spatial import cKDTree

from arcgym.anatomy import read_colon
from arcgym.anatomy.importing import ImportSettings, import_to_folder
from arcgym.anatomy.importing.cleaning import keep_colon
from arcgym.anatomy.importing.volumes import read_volume
from arcgym.anatomy.mucosa.vessel_styles import STYLES
from arcgym.anatomy.validation.checks import failed
from arcgym.anatomy.validation.stage_checks import inspect_file
from arcgym.sim.wall.wall_topology import lumen_topology

COARSE = ImportSettings(voxel=0.0025)


@pytest.mark.parametrize("kind", DIRECTIONS)
def test_directions_put_the_lumen_where_it_is(kind: str, tmp_path: Path) -> None:
    """Every lumen voxel is within the radius (and a voxel) of the true course, whatever the file's axes."""
    grid = read_volume(write_volume(tmp_path / "tube.mha", DIRECTIONS[kind], voxel=4.0), None, None, 0.004)
    distance, nearest = cKDTree(course()[0]).query(grid.points(np.argwhere(grid.mask)))
    assert distance.max() < RADIUS + 0.004
    assert len(np.unique(nearest)) > 0.5 * len(course()[0])


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Import the tube with a gap of 15 mm and, beside it, a loop that is no colon."""
    folder = tmp_path_factory.mktemp("colon")
    loop = np.array([0.0, 0.02, 0.42]) + np.linspace(0, 0.1, 60)[:, None] * [1.0, 0.0, 0.0]
    volume = write_volume(folder / "tube.nii.gz", DIRECTIONS["flipped_xy"], gap=0.015 + 2 * RADIUS, extra=loop)
    report = import_to_folder(volume, folder / "tube", COARSE)
    assert len(report["cleaning"]["bridges"]) == 1
    assert len(report["cleaning"]["dropped"]) == 1
    assert {path.name for path in folder.iterdir()} == {"tube.nii.gz", "tube"}
    return folder / "tube"


def test_length_and_course_are_the_tubes(imported: Path) -> None:
    stage = read_colon(imported / "colon.usda")
    line, length = course()
    assert stage.length == pytest.approx(length + 2 * RADIUS, rel=0.02)
    offset = np.array(stage.metadata["translationAfterRotation"])
    beyond = stage.centerline.points[stage.centerline.arc > 0.08] - offset
    assert np.quantile(cKDTree(line).query(beyond)[0], 0.95) < 0.006


def test_stage_passes_its_checks(imported: Path) -> None:
    """Schema, usdchecker, meshes, lumen, landmarks, anchors: all that validate_colon.py checks without physics."""
    assert failed(inspect_file(str(imported / "colon.usda"))[1]) == []


def test_landmark_by_position_and_a_finer_wall(tmp_path: Path) -> None:
    line, _ = course()
    place = tuple(float(value) for value in 1e3 * line[100])
    settings = replace(COARSE, landmarks={"rectosigmoid": place}, posture="prone", sectors=16, rings=120)
    report = import_to_folder(write_volume(tmp_path / "tube.mha"), tmp_path / "tube", settings)
    stage = read_colon(tmp_path / "tube" / "colon.usda")
    assert [check for check in report["checks"] if not check["ok"]] == []
    assert stage.wall.num_sectors == 16
    assert stage.wall.num_rings == 120 and stage.contact is not None and stage.contact.columns == 48
    assert stage.landmarks["rectosigmoid"] == pytest.approx(0.200 + RADIUS, abs=0.008)
    assert stage.metadata["gravityInScan"] == [0.0, 1.0, 0.0]


def test_canal_rises_from_the_origin(imported: Path) -> None:
    stage = read_colon(imported / "colon.usda")
    start = stage.centerline.points[:3]
    assert np.abs(start[0]).max() < 1e-6
    assert (start[2] - start[0])[2] == pytest.approx(0.01, abs=0.001)


def test_every_segment_shows_its_own_vessels(imported: Path) -> None:
    """v lies in the band of the texture that is drawn for the segment, except on the dome, which has its own chart."""
    stage = read_colon(imported / "colon.usda")
    arc = (stage.visual.skin_weights * stage.wall.ring_arc[stage.wall.ring[stage.visual.skin_indices]]).sum(1)
    for style in STYLES:
        start, end = (stage.segment_bounds()[style.segments[k]][k] for k in (0, -1))
        here = (arc > start + 0.006) & (arc < min(end, stage.length - 0.04) - 0.006)
        v = stage.visual.uv[here, 1]
        assert style.band[0] - 1e-3 < v.min() and v.max() < style.band[1] + 1e-3


def test_simulator_takes_the_wall(imported: Path) -> None:
    """Tets join adjacent rings only and every ring has lumen faces."""
    from arcgym.anatomy import inner_faces

    wall = read_colon(imported / "colon.usda").wall
    assert np.ptp(wall.ring[wall.tets], axis=1).max() == 1
    topology = lumen_topology(wall.points, inner_faces(wall.tets, wall.layer), wall.ring, wall.layer)
    assert topology.rings.shape == (wall.num_rings, wall.num_sectors)


def test_report_and_pictures_are_beside_the_stage(imported: Path) -> None:
    assert {"colon.usda", "colon.usdc", "report.json", "report.png"} <= {path.name for path in imported.iterdir()}


def test_gap_longer_than_allowed_is_not_bridged(tmp_path: Path) -> None:
    volume = write_volume(tmp_path / "tube.mha", gap=0.03 + 2 * RADIUS, voxel=4.0)
    _, cleaning = keep_colon(read_volume(volume, None, None, 0.004), max_gap=0.01)
    assert len(cleaning.dropped) == 1 and not cleaning.bridges
