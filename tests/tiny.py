# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A tiny colon for tests: a short tube, straight up from the anus or bent to the front."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from arcgym.anatomy import Centerline, ColonStage, TissueMaterial, VisualMesh, segment_index, write_colon
from arcgym.anatomy.meshing.surface_grid import grid_triangles, skin_to_rings, smooth_normals
from arcgym.anatomy.meshing.wall import build_wall
from arcgym.anatomy.stage.types import TEXTURE_LENGTH

TINY_SEGMENTS = ("rectum", "sigmoid", "descending", "splenic", "transverse")


def tiny_colon_stage(
    length: float = 0.20,
    radius: float = 0.020,
    rings: int = 17,
    sectors: int = 8,
    bend: float = 0.0,
    thickness: float = 0.002,
    segments: tuple[str, ...] = TINY_SEGMENTS,
    capped: bool = True,
    texture_folder: Path | None = None,
) -> ColonStage:
    """Makes a tube of equally long segments with a visual surface (48 x 24) and a proxy (33 x 16).

    Args:
        length: Length of the centerline [m].
        radius: Radius of the lumen [m].
        rings: Wall rings.
        sectors: Wall vertices around a ring.
        bend: Angle by which the tube turns towards +Y over its length [rad].
        thickness: Wall thickness [m].
        segments: Names of the segments that share the length.
        capped: Closes the blind end.
        texture_folder: Where to put the two 64 x 128 textures; a new temporary folder by default.
    """
    ring_arc = np.linspace(0, length, rings)
    codes = np.array([segment_index(name) for name in segments])
    code_at = lambda s: codes[np.minimum((s / length * len(codes)).astype(int), len(codes) - 1)]  # noqa: E731
    theta = np.arange(sectors) * 2 * np.pi / sectors
    layers = np.stack([tube_points(ring_arc, theta, r, length, bend) for r in (radius, radius + thickness)])
    if capped:
        layers[1, -1] += thickness * np.array([0.0, np.sin(bend), np.cos(bend)])
    arc = np.linspace(0, length, 41)
    albedo, detail = _textures(Path(texture_folder or tempfile.mkdtemp()))
    names = ["anal_verge", *(f"{a}_{b}" for a, b in zip(segments, segments[1:], strict=False)), "blind_end"]
    return ColonStage(
        name="tiny",
        wall=build_wall(layers, code_at(ring_arc), ring_arc, capped),
        visual=_visual(48, 24, ring_arc, sectors, radius, bend),
        visual_proxy=_visual(33, 16, ring_arc, sectors, radius, bend),
        centerline=Centerline(
            points=tube_points(arc, np.zeros(1), 0.0, length, bend)[:, 0].astype(np.float32),
            arc=arc.astype(np.float32),
            radius=np.full(len(arc), radius, np.float32),
            segment=code_at(arc).astype(np.int32),
        ),
        landmarks=dict(zip(names, np.linspace(0, length, len(names)).tolist(), strict=True)),
        material=TissueMaterial(),
        albedo_texture=albedo,
        detail_texture=detail,
        metadata={"provenance": "tests/tiny.py", "licence": "BSD-3-Clause", "patient": "none"},
    )


def write_tiny_colon(folder: Path, **kwargs) -> Path:
    """Writes ``folder/colon.usda`` and returns its path; ``kwargs`` as for :func:`tiny_colon_stage`."""
    return write_colon(tiny_colon_stage(texture_folder=folder, **kwargs), folder / "colon.usda")


def tube_points(s: np.ndarray, theta: np.ndarray, radius: float, length: float, bend: float) -> np.ndarray:
    """Returns points on a circular bend about an axis along +X, shape (len(s), len(theta), 3)."""
    angle = bend * s / length
    turn = length / bend if bend else 0.0
    y = turn * (1 - np.cos(angle)) if bend else np.zeros_like(s)
    z = turn * np.sin(angle) if bend else s
    center = np.stack([np.zeros_like(s), y, z], 1)
    across = np.broadcast_to([1.0, 0.0, 0.0], center.shape)
    inwards = np.stack([np.zeros_like(s), np.cos(angle), -np.sin(angle)], 1)
    around = np.cos(theta)[None, :, None] * across[:, None] + np.sin(theta)[None, :, None] * inwards[:, None]
    return center[:, None] + radius * around


def _visual(rows: int, columns: int, ring_arc: np.ndarray, sectors: int, radius: float, bend: float) -> VisualMesh:
    length = ring_arc[-1]
    s, theta = np.linspace(0, length, rows), np.linspace(0, 2 * np.pi, columns + 1)
    points = tube_points(s, theta, radius, length, bend).reshape(-1, 3).astype(np.float32)
    s, theta = (grid.ravel() for grid in np.meshgrid(s, theta, indexing="ij"))
    faces = grid_triangles(rows, columns + 1)
    skin_indices, skin_weights = skin_to_rings(s, theta, ring_arc, sectors)
    return VisualMesh(
        points=points,
        faces=faces,
        normals=smooth_normals(points, faces),
        uv=np.stack([theta / (2 * np.pi), s / TEXTURE_LENGTH], 1).astype(np.float32),
        tint=np.zeros(len(points), np.float32),
        skin_indices=skin_indices,
        skin_weights=skin_weights,
    )


def _textures(folder: Path) -> tuple[Path, Path]:
    rng = np.random.default_rng(0)
    for name, low, high in (("albedo", (190, 90, 80), (220, 130, 110)), ("detail", (120, 120, 100, 100), (136,) * 4)):
        image = rng.integers(low, high, (128, 64, len(low)), dtype=np.uint8)
        Image.fromarray(image).save(folder / f"{name}.png")
    return folder / "albedo.png", folder / "detail.png"
