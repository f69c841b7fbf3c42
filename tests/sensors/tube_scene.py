# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A straight tube of colon with a camera on its axis: the smallest scene that the camera's tests need."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import torch
import warp as wp
from PIL import Image

from arcgym.anatomy.stage.types import VisualMesh, WallMesh
from arcgym.assets.endoscope_spec import CameraSpec

RADIUS = 0.02
LENGTH = 0.3
MIDDLE = (0.0, 0.0, 0.15)
FORWARD = (1.0, 0.0, 0.0, 0.0)
"""Half a turn about X: the camera looks along +Z of the world."""


def tube_points(rings: int, sectors: int, radius: float = RADIUS) -> np.ndarray:
    """Grid of vertices, ring by ring, shape (rings * sectors, 3)."""
    z, angle = np.meshgrid(np.linspace(0, LENGTH, rings), np.arange(sectors) * 2 * np.pi / sectors, indexing="ij")
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], -1).reshape(-1, 3).astype(np.float32)


def tube_wall(rings: int = 31, sectors: int = 16, radius: float = RADIUS) -> WallMesh:
    """Return the simulated surface (one layer, no tetrahedra: the camera reads neither)."""
    ring, sector = (a.ravel() for a in np.mgrid[:rings, :sectors])
    neighbors = np.stack(
        [
            np.minimum(ring + 1, rings - 1) * sectors + sector,
            np.maximum(ring - 1, 0) * sectors + sector,
            ring * sectors + (sector + 1) % sectors,
            ring * sectors + (sector - 1) % sectors,
        ],
        axis=1,
    )
    zeros = np.zeros(rings * sectors, dtype=np.int32)
    return WallMesh(
        points=tube_points(rings, sectors, radius),
        tets=np.zeros((0, 4), dtype=np.int32),
        anchor=zeros,
        segment=zeros,
        ring=ring.astype(np.int32),
        layer=zeros,
        frame_neighbors=neighbors.astype(np.int32),
        ring_arc=np.linspace(0, LENGTH, rings).astype(np.float32),
    )


def tube_visual(wall: WallMesh, fine: int = 3, sectors: int = 16, radius: float = RADIUS) -> VisualMesh:
    """Return the surface for the camera: `fine` times as many sectors, bound to the two wall vertices beside each."""
    rings, around = wall.num_rings, fine * sectors
    points = tube_points(rings, around, radius)
    ring, column = (a.ravel() for a in np.mgrid[:rings, :around])
    left, share = column // fine, (column % fine) / fine
    skin = np.stack([ring * sectors + left, ring * sectors + (left + 1) % sectors], axis=1)
    corner, beside = ring * around + column, ring * around + (column + 1) % around
    inner = ring < rings - 1
    a, b, c, d = corner[inner], beside[inner], corner[inner] + around, beside[inner] + around
    faces = np.concatenate([np.stack([a, c, b], 1), np.stack([b, c, d], 1)])
    return VisualMesh(
        points=points,
        faces=faces.astype(np.int32),
        normals=(-points * (1.0, 1.0, 0.0) / radius).astype(np.float32),
        uv=np.stack([column / around, points[:, 2] / 0.24], axis=1).astype(np.float32),
        tint=np.zeros(len(points), dtype=np.float32),
        skin_indices=np.pad(skin, ((0, 0), (0, 2))).astype(np.int32),
        skin_weights=np.stack([1 - share, share, 0 * share, 0 * share], axis=1).astype(np.float32),
    )


def write_textures(folder: Path, plain: bool = False) -> tuple[Path, Path]:
    """Write albedo and detail images of 16 px: noise on pink, or one even color without relief."""
    rng = np.random.default_rng(0)
    albedo = np.tile(np.array([217, 120, 100, 255], dtype=np.uint8), (16, 16, 1))
    detail = np.full((16, 16, 4), (128, 128, 128, 255), dtype=np.uint8)
    if not plain:
        albedo[..., :3] = rng.integers(90, 220, (16, 16, 3))
    paths = folder / "albedo.png", folder / "detail.png"
    for path, image in zip(paths, (albedo, detail), strict=True):
        Image.fromarray(image).save(path)
    return paths


class TubeScene(dict):
    """Stand-in for the scene: ``scene["colon"]``, ``scene["endoscope"]`` and the two numbers of a scene."""

    def __init__(
        self, folder: Path, num_envs: int = 1, radius: float = RADIUS, plain: bool = False, device: str = "cpu"
    ) -> None:
        super().__init__()
        self.num_envs, self.device = num_envs, device
        wall = tube_wall(radius=radius)
        visual = tube_visual(wall, radius=radius)
        albedo, detail = write_textures(folder, plain)
        patient = SimpleNamespace(
            wall=wall,
            visual=visual,
            albedo_texture=albedo,
            detail_texture=detail,
            stage=SimpleNamespace(visual=visual),
        )
        self["colon"] = SimpleNamespace(
            patients=(patient,),
            patient_of=lambda env_id: patient,
            patient_wp=wp.zeros(num_envs, dtype=int, device=device),
            wall_version=None,
            nodal_pos_wp=wp.array(np.repeat(wall.points[:, None], num_envs, axis=1), dtype=wp.vec3, device=device),
        )
        camera = CameraSpec((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), np.radians(150.0), (0.001, 0.6))
        pose = np.array([*MIDDLE, *FORWARD], dtype=np.float32)
        self["endoscope"] = SimpleNamespace(
            stage=SimpleNamespace(camera=camera, lights=np.zeros((2, 3))),
            camera_pose_wp=wp.array(np.tile(pose, (num_envs, 1)), dtype=wp.transform, device=device),
        )

    def move_wall(self, world: int, points: np.ndarray) -> None:
        """Put the wall of one world at `points` [m], shape (V, 3)."""
        wp.to_torch(self["colon"].nodal_pos_wp)[:, world] = torch.as_tensor(points, dtype=torch.float32)

    def move_camera(self, world: int, pose: Sequence[float]) -> None:
        """Put the camera of one world at `pose`: position [m] and quaternion (x, y, z, w)."""
        wp.to_torch(self["endoscope"].camera_pose_wp)[world] = torch.as_tensor(pose, dtype=torch.float32)

    @property
    def rest(self) -> np.ndarray:
        """Wall vertices at rest [m], shape (V, 3)."""
        return self["colon"].patients[0].wall.points
