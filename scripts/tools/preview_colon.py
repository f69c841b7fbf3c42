#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draws a colon on one page: from outside, its wall unrolled, and six views from inside with ARCGym's camera."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import cKDTree

if TYPE_CHECKING:
    from arcgym.anatomy import ColonStage

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

STRIP = 150
"""Height of the unrolled wall [px]."""

GROUND = (16, 19, 25)
INK = (236, 240, 246)


def main() -> None:
    """Parses the command line and writes the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("stage", type=Path, help="stage file (colon.usda)")
    parser.add_argument("out", type=Path, help="picture to write (.png or .jpg)")
    args = parser.parse_args()
    from arcgym.anatomy import StageError, read_colon

    try:
        stage = read_colon(args.stage)
    except StageError as error:
        parser.error(str(error))
    args.out.parent.mkdir(parents=True, exist_ok=True)
    draw_page(stage).save(args.out, quality=85)
    print(args.out)


def draw_page(stage: ColonStage) -> Image.Image:
    """Draws the whole page."""
    width = 6 * SIZE
    outside = [Image.fromarray(picture) for picture in outside_views(stage, width // 2, 2 * SIZE)]
    page = Image.new("RGB", (width, 2 * SIZE + STRIP + SIZE), GROUND)
    pen = ImageDraw.Draw(page)
    for k, picture in enumerate(outside):
        page.paste(picture, (k * width // 2, 0))
    page.paste(Image.fromarray(unrolled_wall(stage, width, STRIP - 24)), (0, 2 * SIZE + 20))
    for name, (start, _) in stage.segment_bounds().items():
        pen.text((start / stage.length * width + 2, 2 * SIZE + 4), name, fill=INK)
    for k, (name, view) in enumerate(inside_views(stage)):
        page.paste(Image.fromarray(view), (k * SIZE, 2 * SIZE + STRIP))
        pen.text((k * SIZE + 6, 2 * SIZE + STRIP + 4), name, fill=INK)
    pen.text((8, 6), f"{stage.name}: {stage.metadata.get('patient', '')}, {stage.length:.2f} m", fill=GROUND)
    pen.text((8, 22), "from the front", fill=GROUND)
    pen.text((width // 2 + 8, 22), "from the patient's left", fill=GROUND)
    return page


def outside_views(stage: ColonStage, width: int, height: int) -> list[np.ndarray]:
    """Draws the translucent colon from the front and from the patient's left."""
    from arcgym.sensors import SkinnedSurface
    from arcgym.viewers.outside_view import OutsideView, OutsideViewCfg

    surface = SkinnedSurface(stage.visual_proxy, stage.wall, 1, "cpu")
    pictures = []
    for azimuth in (0.0, 0.5 * math.pi):
        cfg = OutsideViewCfg(width=width, height=height, azimuth=azimuth, outside_length=0.0)
        speck = np.full(2, 1e-4)
        view = OutsideView(cfg, surface, stage.visual_proxy.points, speck, speck)
        hidden = np.tile(stage.centerline.points[0], (2, 1))
        pictures.append(view.render(hidden, np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)), np.zeros(2)))
    return pictures


def unrolled_wall(stage: ColonStage, width: int, height: int) -> np.ndarray:
    """Draws the wall cut open along its length: mucosa shaded by height, polyps green, diverticula blue."""
    visual, line = stage.visual, stage.centerline
    s, u = wall_coordinates(stage)
    center = np.stack([np.interp(s, line.arc, line.points[:, k]) for k in range(3)], 1)
    reach = np.linalg.norm(visual.points - center, axis=1) / np.interp(s, line.arc, line.radius)
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * stage.length, (np.arange(height) + 0.5) / height)
    around = 2 * np.pi * float(np.median(line.radius))
    place, where = np.stack([s, around * u], 1), np.stack([x.ravel(), around * y.ravel()], 1)
    _, near = cKDTree(place).query(where)
    turn = np.exp(2j * np.pi * visual.uv)
    uv = np.angle(LinearNDInterpolator(place, turn)(where)) / (2 * np.pi)
    uv = np.where(np.isnan(uv), visual.uv[near], uv)
    with Image.open(stage.albedo_texture) as image:
        albedo = np.asarray(image.convert("RGB"), float)
    columns, rows = (np.mod(uv, 1.0) * [albedo.shape[1] - 1, len(albedo) - 1]).astype(int).T
    columns, rows = columns.reshape(height, width), rows.reshape(height, width)
    shade = np.clip(1.6 - 0.85 * reach[near], 0.25, 1.25).reshape(height, width, 1)
    tint = visual.tint[near].reshape(height, width, 1)
    picture = albedo[rows, columns] * shade
    picture += np.clip(tint, 0, 0.8) * (np.array([90, 220, 90]) - picture)
    picture += np.clip(-tint, 0, 0.8) * (np.array([50, 90, 230]) - picture)
    return np.clip(picture, 0, 255).astype(np.uint8)


def wall_coordinates(stage: ColonStage) -> tuple[np.ndarray, np.ndarray]:
    """Returns arc length [m] and turn around the lumen (0 to 1) of each fine vertex, from the wall that carries it."""
    wall, visual = stage.wall, stage.visual
    sector = visual.skin_indices % wall.num_sectors
    s = (visual.skin_weights * wall.ring_arc[wall.ring[visual.skin_indices]]).sum(1)
    turn = (visual.skin_weights * np.exp(2j * np.pi * sector / wall.num_sectors)).sum(1)
    return s, np.mod(np.angle(turn) / (2 * np.pi), 1.0)


def inside_views(stage: ColonStage) -> list[tuple[str, np.ndarray]]:
    """Draws what the colonoscope's camera sees from the middle of the lumen, looking upstream."""
    import warp as wp

    from arcgym.assets import PROXIMAL_CFG
    from arcgym.assets.endoscope_stage import read_endoscope
    from arcgym.sensors import EndoscopeCameraCfg, SkinnedSurface
    from arcgym.sensors.endoscope_camera import lights_in_camera
    from arcgym.sensors.mucosa_textures import MucosaTextures
    from arcgym.sensors.surface_renderer import Optics, SurfaceRenderer, WorldLooks
    from arcgym.utils.paths import resolve_asset

    scope, cfg = read_endoscope(resolve_asset(PROXIMAL_CFG.usd_path)), EndoscopeCameraCfg()
    camera, lights = scope.camera, lights_in_camera(scope.lights, scope.camera)
    near = float(camera.clipping[0])
    optics = Optics(camera.field_of_view, lights, near, cfg.far, cfg.lighting, cfg.exposure)
    textures = MucosaTextures(stage.albedo_texture, stage.detail_texture, "cpu", smooth_levels=True)
    surface = SkinnedSurface(stage.visual, stage.wall, 1, "cpu")
    renderer = SurfaceRenderer(surface, stage.visual, textures, optics, (SIZE, SIZE), 4)
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
    """Returns position and quaternion of a camera at ``s`` that looks 30 mm ahead along the centreline, shape (7,)."""
    from scipy.spatial.transform import Rotation

    line = stage.centerline
    here, ahead = (np.array([np.interp(at, line.arc, line.points[:, k]) for k in range(3)]) for at in (s, s + 0.03))
    back = (here - ahead) / np.linalg.norm(here - ahead)
    right = np.cross([0.0, 1.0, 0.1], back)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(back, right), back], 1)
    return np.r_[here, Rotation.from_matrix(axes).as_quat()].astype(np.float32)


if __name__ == "__main__":
    main()
