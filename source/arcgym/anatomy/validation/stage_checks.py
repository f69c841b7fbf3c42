# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""All checks of a stage that needs no simulation; ``arcgym validate`` prints them."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdValidation
from scipy.spatial import cKDTree

from arcgym.anatomy.course_measures import measure_course
from arcgym.anatomy.measures import flipped_normal_fraction, inner_faces, winds_outwards
from arcgym.anatomy.segments import ANCHOR_ELASTIC, ANCHOR_FIXED, ANCHOR_FREE, RETROPERITONEAL, SEGMENTS
from arcgym.anatomy.stage import StageError, read_colon
from arcgym.anatomy.stage.types import ColonStage, VisualMesh, WallMesh
from arcgym.anatomy.validation.checks import Check
from arcgym.anatomy.validation.mesh_checks import (
    boundary_faces,
    cap_openings,
    count_crossings,
    edge_uses,
    winding_numbers,
)
from arcgym.anatomy.validation.passage import HEAD_LENGTH, HEAD_RADIUS, head_passage
from arcgym.anatomy.validation.wall_checks import check_wall

_LENGTH_RANGE = 0.1, 3.0
"""Least and largest length of a colon or a piece of one [m]."""

_DIAMETER_RANGE = 0.010, 0.120
"""Least and largest median diameter [m]."""

_LEAST_BEND = 0.006
"""Least bend radius of a centerline smoothed over 5 mm [m]; real colons have 10 to 15 mm (docs/importing.md)."""


def inspect_file(path: str) -> tuple[ColonStage | None, list[Check]]:
    """Read a stage and check it; where it cannot be read, the only check is the failed one that says why."""
    try:
        stage = read_colon(path)
    except StageError as error:
        return None, [Check(f"schema and units: {error}", np.nan, np.nan, at_least=False)]
    return stage, [*_check_schema(path), *inspect_stage(stage)]


def inspect_stage(stage: ColonStage) -> list[Check]:
    """Check a stage in memory: size, meshes, topology, centerline, anchors."""
    return [
        *_check_size(stage),
        *_check_meshes(stage),
        *_check_topology(stage.wall),
        _check_centerline(stage),
        *_check_way(stage),
        *_check_anchors(stage.wall),
    ]


def _check_schema(path: str) -> list[Check]:
    """Run all validators of OpenUSD, as ``usdchecker`` does; reading has checked ARCGym's own schema and units."""
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    errors = [error.GetMessage() for error in context.Validate(Usd.Stage.Open(path))]
    name = "errors found by usdchecker" + "".join(f"; {error}" for error in errors[:3])
    return [Check("errors on reading schema and units", 0, 0, at_least=False), Check(name, len(errors), 0, False)]


def _check_size(stage: ColonStage) -> list[Check]:
    """Catch millimeters taken for meters, and the reverse."""
    diameter = 2 * float(np.median(stage.centerline.radius))
    return [
        Check("length [m]", stage.length, _LENGTH_RANGE[0], at_least=True),
        Check("length, upper bound [m]", stage.length, _LENGTH_RANGE[1], at_least=False),
        Check("median diameter [m]", diameter, _DIAMETER_RANGE[0], at_least=True),
        Check("median diameter, upper bound [m]", diameter, _DIAMETER_RANGE[1], at_least=False),
    ]


def _check_meshes(stage: ColonStage) -> list[Check]:
    """Check wall, visual surfaces, landmarks and handedness."""
    apart = np.diff(list(stage.landmarks.values())).min(initial=stage.length)
    return [
        *check_wall(stage.wall),
        *_check_visual("render surface", stage.visual, stage.wall),
        *_check_visual("proxy surface", stage.visual_proxy, stage.wall),
        *_check_contact(stage),
        Check("least distance of landmarks [m]", float(apart), 0.0, at_least=True),
        *_check_sides(stage),
    ]


def _check_sides(stage: ColonStage) -> list[Check]:
    """Find mirrored anatomies: the ascending colon is on the patient's right. Empty where there is only one side."""
    left, right = (stage.centerline.segment == SEGMENTS.index(name) for name in ("descending", "ascending"))
    if not (left.any() and right.any()):
        return []
    x = stage.centerline.points[:, 0]
    return [Check("ascending minus descending x [m]", float(x[right].mean() - x[left].mean()), 0.05, at_least=True)]


def _check_visual(name: str, visual: VisualMesh, wall: WallMesh) -> list[Check]:
    sums = np.abs(visual.skin_weights.astype(float).sum(1) - 1.0).max()
    carriers = wall.points[visual.skin_indices]
    anchor = np.einsum("mk,mkd->md", visual.skin_weights, carriers)
    return [
        Check(f"{name}: error of skin weight sums", float(sums), 1e-5, at_least=False),
        Check(f"{name}: least skin weight", float(visual.skin_weights.min()), 0.0, at_least=True),
        Check(f"{name}: wall layer it is skinned to", float(wall.layer[visual.skin_indices].max()), 0.0, False),
        Check(f"{name}: distance to its carriers [m]", _largest_distance(visual.points, anchor), 0.04, at_least=False),
        Check(f"{name}: faces wound outwards", float(winds_outwards(visual.points, visual.faces)), 0.0, False),
        Check(f"{name}: share of flipped normals", flipped_normal_fraction(visual), 0.01, at_least=False),
    ]


def _check_contact(stage: ColonStage) -> list[Check]:
    """Check what the scope touches against wall and fine surface; empty where it touches the wall."""
    contact, wall = stage.contact, stage.wall
    if contact is None:
        return []
    anchor = np.einsum("mk,mkd->md", contact.skin_weights, wall.points[contact.skin_indices])
    off = cKDTree(stage.visual.points).query(contact.points)[0]
    return [
        Check(
            "contact surface: wall layer it is skinned to", float(wall.layer[contact.skin_indices].max()), 0.0, False
        ),
        Check("contact surface: distance to its carriers [m]", _largest_distance(contact.points, anchor), 0.04, False),
        Check("contact surface: distance to the fine one, 95 % [m]", float(np.percentile(off, 95)), 0.003, False),
        Check("contact surface: wound outwards", winds_outwards(contact.points, contact.faces()), 1.0, True),
    ]


def _largest_distance(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.linalg.norm(a - b, axis=1).max())


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
    """Find centerline points outside the lumen; the end rings' planes may leave out a point each."""
    wall, line = stage.wall, stage.centerline
    lumen = cap_openings(inner_faces(wall.tets, wall.layer))
    margin = 0.5 * float(np.median(np.diff(wall.ring_arc)))
    within = (line.arc > wall.ring_arc[0] + margin) & (line.arc < wall.ring_arc[-1] - margin)
    outside = winding_numbers(wall.points, lumen, line.points[within]) < 0.5
    return Check("centerline points outside the lumen", int(outside.sum()), 0, at_least=False)


def _check_way(stage: ColonStage) -> list[Check]:
    """Check that the course bends no tighter than a lumen can, and that a scope's stiff head passes."""
    line = stage.centerline
    bend = measure_course(line.points.astype(float)).bend_radius_least
    found = head_passage(stage)
    size = f"{1e3 * HEAD_LENGTH:.0f} mm long, tightest {found.tightest:.3f} m up"
    return [
        Check("least bend radius [m]", bend, _LEAST_BEND, at_least=True),
        Check(f"passage: radius of a stiff head [m], {size}", found.least, HEAD_RADIUS, at_least=True),
    ]


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
