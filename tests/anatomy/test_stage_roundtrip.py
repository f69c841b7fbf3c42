# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A colon written to USD and read back is the same colon."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from tiny import tiny_colon_stage, write_tiny_colon

from arcgym.anatomy import ColonStage, read_colon
from arcgym.anatomy.measures import inner_faces, tet_volumes


@pytest.mark.parametrize("part", ["wall", "visual", "visual_proxy", "centerline"])
def test_arrays_survive(tiny_colon_path: Path, part: str) -> None:
    made, read = getattr(tiny_colon_stage(), part), getattr(read_colon(tiny_colon_path), part)
    for item in fields(made):
        a, b = getattr(made, item.name), getattr(read, item.name)
        assert a.dtype == b.dtype and np.array_equal(a, b), item.name


def test_names_and_numbers_survive(tiny_colon_path: Path) -> None:
    made, read = tiny_colon_stage(), read_colon(tiny_colon_path)
    assert read.landmarks == pytest.approx(made.landmarks)
    assert read.material == made.material
    assert read.name == "tiny" and read.metadata["licence"] == "BSD-3-Clause"


def test_segment_bounds() -> None:
    stage: ColonStage = tiny_colon_stage()
    assert stage.segment_bounds()["descending"] == pytest.approx((0.08, 0.12), abs=0.006)
    assert stage.segment_at(0.05) == "sigmoid" and stage.segment_at(1.0) == "transverse"


def test_same_stage_same_bytes(tmp_path: Path) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    for folder in (first, second):
        folder.mkdir()
        write_tiny_colon(folder)
    for name in ("colon.usda", "colon.usdc"):
        assert (first / name).read_bytes() == (second / name).read_bytes(), name


def test_tube_wall_volume() -> None:
    """Between two octagonal prisms: the difference of the octagons' areas times the length."""
    stage = tiny_colon_stage(capped=False)
    octagon = lambda r: 8 * 0.5 * r**2 * np.sin(np.pi / 4)  # noqa: E731
    volume = tet_volumes(stage.wall.points, stage.wall.tets).sum()
    assert volume == pytest.approx(0.20 * (octagon(0.022) - octagon(0.020)), rel=1e-4)


def test_inner_faces_point_into_the_wall() -> None:
    wall = tiny_colon_stage(capped=False).wall
    faces = inner_faces(wall.tets, wall.layer)
    corners = wall.points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    radial = corners.mean(1) * [1, 1, 0]
    assert len(faces) == 2 * 16 * 8
    assert (np.einsum("ij,ij->i", normals, radial) > 0).all()
