# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Checks that a colon can be simulated and is anatomically right; used by the generator and on any stage."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy.bends import acute_bends
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.generator.surface import Surface
from arcgym.anatomy.measures import flipped_normal_fraction, tet_quality, tet_volumes, winds_outwards
from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.stage.types import ColonStage, VisualMesh, WallMesh

MIN_TET_QUALITY = 0.04
"""Least mean-ratio quality of a wall tetrahedron. A 2 mm wall with 12 mm edges has about 0.2; 0 is flat."""

LENGTH_TOLERANCE = 0.08
"""Largest relative error of a segment's length."""


BEND_TOLERANCE = 0.85
"""Least radius of the centreline over the wanted one: what relaxation leaves between bends that crowd each other."""

RING_TOLERANCE = 0.32
"""Least distance of two rings on the inside of a bend over their spacing; thinner triangles would hurt the solver."""

_END_SAMPLES = 3
"""Samples at either end of a curve whose curvature does not count."""


@dataclass(frozen=True)
class Check:
    """One figure and the bound that it has to keep."""

    name: str
    """What is checked."""
    value: float
    """What was found."""
    bound: float
    """What is allowed."""
    at_least: bool
    """Whether the bound is a minimum rather than a maximum."""

    @property
    def ok(self) -> bool:
        """Whether the figure keeps its bound; a figure that is not finite never does."""
        kept = self.value >= self.bound if self.at_least else self.value <= self.bound
        return bool(np.isfinite(self.value)) and kept

    def __str__(self) -> str:
        """One line with figure and bound."""
        return f"{self.name} {self.value:.4g} (must be {'>=' if self.at_least else '<='} {self.bound:.4g})"


def failed(checks: Iterable[Check]) -> list[Check]:
    """Return the checks that are not kept."""
    return [check for check in checks if not check.ok]


def validate_curve(spec: ColonSpec, surface: Surface) -> list[Check]:
    """Check a generated centreline against its spec: bends and lengths."""
    curve = surface.curve
    sharpest = float((curve.curvature * surface.mean_radius).max())
    wanted = np.array([spec.segments[name].length for name in SEGMENTS])
    error = np.abs((curve.ends - curve.starts) / wanted - 1.0).max()
    least = 1.0 / float(curve.curvature[_END_SAMPLES:-_END_SAMPLES].max())
    checks = [
        Check("curvature times lumen radius", sharpest, 1.0, at_least=False),
        Check("least bend radius [m]", least, BEND_TOLERANCE * spec.min_bend_radius, at_least=True),
        Check("relative error of segment lengths", float(error), LENGTH_TOLERANCE, at_least=False),
    ]
    if spec.acute_bends is not None:
        off = abs(len(acute_bends(curve.points, curve.s)) - spec.acute_bends)
        checks.append(Check("acute bends more or less than wanted", off, 1, at_least=False))
    return checks


def validate_wall(wall: WallMesh, spec: ColonSpec | None = None) -> list[Check]:
    """Check the wall: tetrahedra, gap between loops, room for the scope."""
    gap = 0.0 if spec is None else spec.clearance
    room = 0.0066 if spec is None else 0.95 * spec.min_lumen_radius
    apart = 0.0 if spec is None else RING_TOLERANCE * spec.ring_spacing
    return [
        Check("least tetrahedron volume [m^3]", float(tet_volumes(wall.points, wall.tets).min()), 1e-12, at_least=True),
        Check("least tetrahedron quality", float(tet_quality(wall.points, wall.tets).min()), MIN_TET_QUALITY, True),
        Check("least distance of rings [m]", ring_distance(wall), apart, at_least=True),
        Check("gap between loops [m]", loop_gap(wall), gap, at_least=True),
        Check("least lumen radius [m]", float(ring_radii(wall).min()), room, at_least=True),
    ]


def validate_stage(stage: ColonStage) -> list[Check]:
    """Check a whole stage: wall, visual surfaces, landmarks, handedness."""
    arcs = np.diff(list(stage.landmarks.values()))
    return [
        *validate_wall(stage.wall),
        *_validate_visual("render surface", stage.visual, stage.wall),
        *_validate_visual("proxy surface", stage.visual_proxy, stage.wall),
        Check("least distance of landmarks [m]", float(arcs.min()), 0.0, at_least=True),
        *_validate_sides(stage),
    ]


def _validate_sides(stage: ColonStage) -> list[Check]:
    """Find mirrored anatomies: the ascending colon is on the patient's right. Empty where there is only one side."""
    left, right = (stage.centerline.segment == SEGMENTS.index(name) for name in ("descending", "ascending"))
    if not (left.any() and right.any()):
        return []
    x = stage.centerline.points[:, 0]
    return [Check("ascending minus descending x [m]", float(x[right].mean() - x[left].mean()), 0.05, at_least=True)]


def _validate_visual(name: str, visual: VisualMesh, wall: WallMesh) -> list[Check]:
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


def _largest_distance(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.linalg.norm(a - b, axis=1).max())


def ring_centers(wall: WallMesh) -> np.ndarray:
    """Return the mean position of each ring's inner vertices [m], shape (R, 3)."""
    inner = wall.points[wall.layer == 0]
    return inner.reshape(wall.num_rings, -1, 3).mean(1)


def ring_distance(wall: WallMesh) -> float:
    """Return the least distance between vertices of neighbouring rings at the middle of the wall [m]."""
    points = wall.points.reshape(wall.layer.max() + 1, wall.num_rings, -1, 3).astype(float)
    return float(np.linalg.norm(np.diff(points.mean(0), axis=0), axis=-1).min())


def ring_radii(wall: WallMesh) -> np.ndarray:
    """Return the least distance from each ring's centre to its inner edges [m], shape (R,)."""
    ring = wall.points[wall.layer == 0].reshape(wall.num_rings, -1, 3).astype(float)
    offset = ring - ring.mean(1, keepdims=True)
    edge = np.roll(offset, -1, axis=1) - offset
    share = np.clip(-(offset * edge).sum(-1) / np.maximum((edge**2).sum(-1), 1e-18), 0.0, 1.0)
    return np.linalg.norm(offset + share[..., None] * edge, axis=-1).min(1)


def loop_gap(wall: WallMesh, reach: float = 0.05) -> float:
    """Return the least distance between outer vertices of different loops [m]; ``reach`` if there are none so near.

    Two rings belong to different loops when the way along the centreline is more than 1.7 times what their radii
    and a straight wall between them would need.
    """
    outer = wall.layer == wall.layer.max()
    points, ring = wall.points[outer], wall.ring[outer]
    width = np.linalg.norm(points - ring_centers(wall)[ring], axis=1)
    radius = np.array([width[ring == k].max() for k in range(wall.num_rings)])
    pairs = cKDTree(points).query_pairs(reach, output_type="ndarray")
    a, b = ring[pairs[:, 0]], ring[pairs[:, 1]]
    other = np.abs(wall.ring_arc[a] - wall.ring_arc[b]) > 1.7 * (radius[a] + radius[b])
    distance = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)[other]
    return float(distance.min()) if len(distance) else reach
