# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Views from inside a colon at rest, as the colonoscope's camera draws them."""

from __future__ import annotations

import numpy as np
import warp as wp
from scipy.spatial.transform import Rotation

from arcgym.anatomy import ColonStage
from arcgym.assets import PROXIMAL_CFG
from arcgym.assets.endoscope_stage import read_endoscope
from arcgym.sensors import EndoscopeCameraCfg, SkinnedSurface
from arcgym.sensors.endoscope_camera import lights_in_camera
from arcgym.sensors.mucosa_textures import MucosaTextures, read_images
from arcgym.sensors.surface_renderer import Optics, SurfaceRenderer, WorldLooks
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.paths import resolve_asset

VIEWS = {
    "rectum": 0.45,
    "sigmoid": 0.5,
    "descending": 0.5,
    "transverse": 0.5,
    "ascending": 0.45,
    "cecum": -0.45,
}
"""Where the inside views are taken: segment, and share of its length."""
SIZE = 256
"""Width and height of an inside view [px]."""


def inside_views(stage: ColonStage) -> list[tuple[str, np.ndarray]]:
    """Draw what the colonoscope's camera sees from the middle of the lumen, looking upstream."""
    scope, cfg = read_endoscope(resolve_asset(PROXIMAL_CFG.usd_path)), EndoscopeCameraCfg()
    camera, lights = scope.camera, lights_in_camera(scope.lights, scope.camera)
    near = float(camera.clipping[0])
    optics = Optics(camera.field_of_view, lights, near, cfg.far, cfg.lighting, cfg.exposure)
    textures = MucosaTextures(*read_images(stage.albedo_texture, stage.detail_texture), "cpu", smooth_levels=True)
    surface = SkinnedSurface(stage.visual, stage.wall, 1, "cpu")
    renderer = SurfaceRenderer(surface, [stage.visual], [textures], optics, (SIZE, SIZE), 4)
    looks, drawn = WorldLooks.neutral(1, "cpu"), wp.full(1, True, dtype=wp.bool, device="cpu")
    views = []
    for name, share in VIEWS.items():
        if name not in stage.segment_bounds():
            continue
        start, end = stage.segment_bounds()[name]
        renderer.gain.zero_()
        pose = wp.array([camera_pose(stage, start + share * (end - start))], dtype=wp.transform, device="cpu")
        renderer.draw(pose, looks, drawn)
        views.append((name, renderer.rgb.numpy()[0].copy()))
    return views


def camera_pose(stage: ColonStage, s: float) -> np.ndarray:
    """Return position and quaternion of a camera at ``s`` that looks 30 mm ahead along the centerline, shape (7,)."""
    line = stage.centerline
    here, ahead = (np.array([np.interp(at, line.arc, line.points[:, k]) for k in range(3)]) for at in (s, s + 0.03))
    back = (here - ahead) / np.linalg.norm(here - ahead)
    right = np.cross([0.0, 1.0, 0.1], back)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(back, right), back], 1)
    return np.r_[here, Rotation.from_matrix(axes).as_quat()].astype(np.float32)
