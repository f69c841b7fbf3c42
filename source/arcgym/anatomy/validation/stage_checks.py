# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""All checks of a stage that needs no simulation; ``arcgym validate`` prints them."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdValidation

from arcgym.anatomy.measures import inner_faces
from arcgym.anatomy.segments import ANCHOR_ELASTIC, ANCHOR_FIXED, ANCHOR_FREE, RETROPERITONEAL, SEGMENTS
from arcgym.anatomy.stage import StageError, read_colon
from arcgym.anatomy.stage.types import ColonStage, WallMesh
from arcgym.anatomy.validation.mesh_checks import (
    boundary_faces,
    cap_openings,
    count_crossings,
    edge_uses,
    winding_numbers,
)
from arcgym.anatomy.validation.validate import Check, validate_stage

_LENGTH_RANGE = 0.1, 3.0
"""Least and largest length of a colon or a piece of one [m]."""

_DIAMETER_RANGE = 0.010, 0.120
"""Least and largest median diameter [m]."""


def inspect_file(path: str) -> tuple[ColonStage | None, list[Check]]:
    """Read a stage and check it; where it cannot be read, the only check is the failed one that says why."""
    try:
        stage = read_colon(path)
    except StageError as error:
        return None, [Check(f"schema and units: {error}", 1, 0, at_least=False)]
    return stage, [*_check_schema(path), *inspect_stage(stage)]


def inspect_stage(stage: ColonStage) -> list[Check]:
    """Check a stage in memory: size, meshes, topology, centreline, anchors."""
    return [
        *_check_size(stage),
        *validate_stage(stage),
        *_check_topology(stage.wall),
        _check_centerline(stage),
        *_check_anchors(stage.wall),
    ]


def _check_schema(path: str) -> list[Check]:
    """Run all validators of OpenUSD, as ``usdchecker`` does; reading has checked ARCGym's own schema and units."""
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    errors = [error.GetMessage() for error in context.Validate(Usd.Stage.Open(path))]
    name = "errors found by usdchecker" + "".join(f"; {error}" for error in errors[:3])
    return [Check("errors on reading schema and units", 0, 0, at_least=False), Check(name, len(errors), 0, False)]


def _check_size(stage: ColonStage) -> list[Check]:
    """Catch millimetres taken for metres, and the reverse."""
    diameter = 2 * float(np.median(stage.centerline.radius))
    return [
        Check("length [m]", stage.length, _LENGTH_RANGE[0], at_least=True),
        Check("length, upper bound [m]", stage.length, _LENGTH_RANGE[1], at_least=False),
        Check("median diameter [m]", diameter, _DIAMETER_RANGE[0], at_least=True),
        Check("median diameter, upper bound [m]", diameter, _DIAMETER_RANGE[1], at_least=False),
    ]


def _check_topology(wall: WallMesh) -> list[Check]:
    boundary, inner = boundary_faces(wall.tets), inner_faces(wall.tets, wall.layer)
    _, uses = edge_uses(boundary)
    edges, inner_uses = edge_uses(inner)
    beyond = wall.ring[edges[inner_uses == 1]].max(initial=0)
    return [
        Check("wall: boundary edges not shared by two faces", int((uses != 2).sum()), 0, at_least=False),
        Check("wall: edges through faces (self-intersections)", count_crossings(wall.points, boundary), 0, False),
        Check("lumen: last ring with an open edge", int(beyond), 0, at_least=False),
    ]


def _check_centerline(stage: ColonStage) -> Check:
    """Find centreline points outside the lumen; the end rings' planes may leave out a point each."""
    wall, line = stage.wall, stage.centerline
    lumen = cap_openings(inner_faces(wall.tets, wall.layer))
    margin = 0.5 * float(np.median(np.diff(wall.ring_arc)))
    within = (line.arc > wall.ring_arc[0] + margin) & (line.arc < wall.ring_arc[-1] - margin)
    outside = winding_numbers(wall.points, lumen, line.points[within]) < 0.5
    return Check("centreline points outside the lumen", int(outside.sum()), 0, at_least=False)


def _check_anchors(wall: WallMesh) -> list[Check]:
    known = np.isin(wall.anchor, [ANCHOR_FREE, ANCHOR_ELASTIC, ANCHOR_FIXED])
    ends = wall.anchor[(wall.ring == 0) | (wall.ring == wall.num_rings - 1)]
    held = np.isin(wall.segment, [SEGMENTS.index(name) for name in RETROPERITONEAL]) & (wall.layer == wall.layer.max())
    free = held & (wall.anchor == ANCHOR_FREE)
    return [
        Check("anchors: unknown codes", int((~known).sum()), 0, at_least=False),
        Check("anchors: vertices of the end rings that can move", int((ends != ANCHOR_FIXED).sum()), 0, False),
        Check("anchors: share of free retroperitoneal vertices", float(free.sum() / max(held.sum(), 1)), 0.25, False),
    ]
