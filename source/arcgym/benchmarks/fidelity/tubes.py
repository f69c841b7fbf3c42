# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tubes with the mesh of the shipped colon's sigmoid, written as stages."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from arcgym.anatomy import (
    ANCHOR_FIXED,
    ANCHOR_FREE,
    SEGMENTS,
    Centerline,
    ColonStage,
    VisualMesh,
    WallMesh,
    read_colon,
    segment_index,
)
from arcgym.anatomy.meshing.surface_grid import grid_triangles, skin_to_rings, smooth_normals
from arcgym.anatomy.meshing.wall import build_wall
from arcgym.anatomy.stage.types import TEXTURE_LENGTH
from arcgym.assets import ColonCfg
from arcgym.assets.patient_files import find_stages

SEGMENT = "sigmoid"
"""Part of the shipped colon that the tubes take their measures from."""
HELD_SPACINGS = (2, 1)
"""Spacings of the shipped rings over which a tube is held at its start and at its end, as the colon is."""
OUTSIDE = -0.5 * np.pi
"""Angle of the outside of a bend, where its first line of vertices is: a tip runs in that groove. In the middle between
two lines it stands on a ridge, from which it slides to the one side or the other: both are right."""
FREE = dict.fromkeys(SEGMENTS, 0.0)
"""Anchor stiffness of a tube that is held at its ends alone."""


@dataclass(frozen=True)
class Tube:
    """A straight tube with one circular bend towards +Y."""

    length: float
    """[m]."""
    bend: float = 0.0
    """Angle of the bend [rad]."""
    bend_start: float = 0.0
    """Arc length at which it starts [m]."""
    bend_radius: float = 0.05
    """Radius of the centerline in the bend [m]."""
    refine: int = 1
    """Rings and sectors for each one of the shipped mesh."""
    radius: float | None = None
    """Radius of the lumen [m]; the shipped colon's by default."""

    def spacing(self) -> float:
        """Return the distance of its rings on the shipped mesh [m], which divides the length."""
        return self.length / round(self.length / wall_measures().spacing)

    def frame(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the points of the centerline [m], shape (n, 3), and its angle from the Z axis [rad], shape (n,)."""
        angle = np.clip((s - self.bend_start) / self.bend_radius, 0.0, self.bend)
        before = np.minimum(s, self.bend_start) if self.bend else s
        after = np.maximum(0.0, s - self.bend_start - self.bend * self.bend_radius) if self.bend else 0.0 * s
        y = self.bend_radius * (1.0 - np.cos(angle)) + after * np.sin(angle)
        z = before + self.bend_radius * np.sin(angle) + after * np.cos(angle)
        return np.stack([0.0 * s, y, z], axis=1), angle

    def surface(self, s: np.ndarray, theta: np.ndarray, radius: float) -> np.ndarray:
        """Return the points at arc lengths, angles around and a distance from the centerline [m], shape (S, A, 3)."""
        center, angle = self.frame(s)
        inwards = np.stack([0.0 * s, np.cos(angle), -np.sin(angle)], axis=1)
        across = np.array([1.0, 0.0, 0.0])
        around = np.cos(theta)[None, :, None] * across + np.sin(theta)[None, :, None] * inwards[:, None]
        return center[:, None] + radius * around


@dataclass(frozen=True)
class WallMeasures:
    """Measures of the shipped wall in the sigmoid."""

    spacing: float
    """Distance of rings [m]."""
    sectors: int
    """Vertices around a ring."""
    radius: float
    """Mean radius of the lumen [m]."""
    thickness: float
    """Wall thickness [m]."""


@cache
def shipped_stage(colon: str | None = None) -> ColonStage:
    """Return a colon that ships with ARCGym, by its stage; the default one if None."""
    return read_colon(find_stages(colon or ColonCfg().usd_path)[0])


@cache
def wall_measures() -> WallMeasures:
    """Measure the shipped colon."""
    wall = shipped_stage().wall
    rings = len(wall.ring_arc)
    inner, outer = wall.points.reshape(2, rings, -1, 3).astype(float)
    radius = np.linalg.norm(inner - inner.mean(axis=1, keepdims=True), axis=2).mean(axis=1)
    here = wall.segment.reshape(2, rings, -1)[0, :, 0] == segment_index(SEGMENT)
    thickness = np.median(np.linalg.norm(outer - inner, axis=2))
    return WallMeasures(
        float(np.diff(wall.ring_arc).mean()), inner.shape[1], float(radius[here].mean()), float(thickness)
    )


def tube_stage(tube: Tube) -> ColonStage:
    """Return a tube with the ring spacing, sectors, radius and thickness of the shipped colon."""
    measures = wall_measures()
    sectors = measures.sectors * tube.refine
    arc = np.linspace(0.0, tube.length, round(tube.length / tube.spacing()) * tube.refine + 1)
    theta = 2.0 * np.pi * np.arange(sectors) / sectors + (OUTSIDE if tube.bend else 0.0)
    radius = measures.radius if tube.radius is None else tube.radius
    radii = (radius, radius + measures.thickness)
    layers = np.stack([tube.surface(arc, theta, r) for r in radii])
    codes = np.full(len(arc), segment_index(SEGMENT), np.int32)
    shipped = shipped_stage()
    visual = grid_visual(tube.surface(arc, theta, radius), arc)
    held = (HELD_SPACINGS[0] * tube.spacing(), tube.length - HELD_SPACINGS[1] * tube.spacing())
    return ColonStage(
        name="tube",
        wall=hold(build_wall(layers, codes, arc, capped=False), *held),
        visual=visual,
        visual_proxy=visual,
        centerline=Centerline(
            tube.frame(arc)[0].astype(np.float32),
            arc.astype(np.float32),
            np.full(len(arc), radius, np.float32),
            codes,
        ),
        landmarks={"anal_verge": 0.0, "blind_end": tube.length},
        material=shipped.material,
        albedo_texture=shipped.albedo_texture,
        detail_texture=shipped.detail_texture,
        metadata={"provenance": "arcgym bench fidelity", "licence": "BSD-3-Clause", "patient": "none"},
    )


def hold(wall: WallMesh, start: float, end: float) -> WallMesh:
    """Return the wall held up to one arc length and from another on [m], however fine its rings are."""
    arc = wall.ring_arc[wall.ring]
    still = (arc < start + 1.0e-4) | (arc > end - 1.0e-4)
    loose = np.where(wall.anchor == ANCHOR_FIXED, ANCHOR_FREE, wall.anchor)
    return replace(wall, anchor=np.where(still, ANCHOR_FIXED, loose).astype(np.int32))


def grid_visual(points: np.ndarray, ring_arc: np.ndarray) -> VisualMesh:
    """Return the inner surface as a visual mesh, which a stage must have.

    Args:
        points: Inner vertices of the wall by ring and sector [m], shape (R, S, 3).
        ring_arc: Arc length of each ring [m], shape (R,).
    """
    rings, sectors, _ = points.shape
    closed = np.concatenate([points, points[:, :1]], axis=1).reshape(-1, 3).astype(np.float32)
    theta = np.linspace(0.0, 2.0 * np.pi, sectors + 1)
    s, angle = (grid.ravel() for grid in np.meshgrid(ring_arc, theta, indexing="ij"))
    faces = grid_triangles(rings, sectors + 1)
    uv = np.stack([angle / (2.0 * np.pi), s / TEXTURE_LENGTH], axis=1).astype(np.float32)
    skin = skin_to_rings(s, angle, ring_arc, sectors)
    return VisualMesh(closed, faces, smooth_normals(closed, faces), uv, np.zeros(len(closed), np.float32), *skin)
