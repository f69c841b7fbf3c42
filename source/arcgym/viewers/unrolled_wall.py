# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The colon's wall cut open along its length."""

from __future__ import annotations

import numpy as np
from PIL import Image
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import cKDTree

from arcgym.anatomy import ColonStage


def unrolled_wall(stage: ColonStage, width: int, height: int) -> np.ndarray:
    """Draw the wall cut open along its length: mucosa shaded by height, polyps green, diverticula blue."""
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
    """Return arc length [m] and turn around the lumen (0 to 1) of each fine vertex, from the wall that carries it."""
    wall, visual = stage.wall, stage.visual
    sector = visual.skin_indices % wall.num_sectors
    s = (visual.skin_weights * wall.ring_arc[wall.ring[visual.skin_indices]]).sum(1)
    turn = (visual.skin_weights * np.exp(2j * np.pi * sector / wall.num_sectors)).sum(1)
    return s, np.mod(np.angle(turn) / (2 * np.pi), 1.0)
