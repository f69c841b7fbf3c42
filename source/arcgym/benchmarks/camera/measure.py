# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures a second of the endoscope camera, without any physics."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import warp as wp

from arcgym.anatomy import Centerline, ColonStage
from arcgym.assets.endoscope_spec import CameraSpec
from arcgym.assets.patient import patient_of_stage
from arcgym.benchmarks.timing import median_ms
from arcgym.sensors import EndoscopeCamera, EndoscopeCameraCfg


class RestingScene(dict):
    """As much of a scene as the camera needs: colons at rest, and cameras along their centerlines."""

    def __init__(self, stage: ColonStage, num_envs: int, device: str) -> None:
        """Copy the colon into `num_envs` worlds and spread the cameras over its length."""
        super().__init__()
        self.num_envs, self.device = num_envs, device
        nodes = np.repeat(stage.wall.points[:, None], num_envs, axis=1)
        optics = SimpleNamespace(
            camera=CameraSpec(position=(0.0, 0.0, 0.0)), lights=np.array([[-0.004, 0.001, 0.0], [0.004, 0.001, 0.0]])
        )
        poses = centerline_poses(stage.centerline, num_envs)
        self["colon"] = SimpleNamespace(
            patients=(patient_of_stage(stage, shell=False),),
            patient_wp=wp.zeros(num_envs, dtype=int, device=device),
            nodal_pos_wp=wp.array(nodes, dtype=wp.vec3, device=device),
            wall_version=None,
        )
        self["endoscope"] = SimpleNamespace(
            stage=optics, camera_pose_wp=wp.array(poses, dtype=wp.transform, device=device)
        )


def centerline_poses(centerline: Centerline, count: int) -> np.ndarray:
    """Return camera poses spread over the middle of the colon, looking along it, shape (count, 7), float32."""
    index = np.linspace(0.1, 0.8, count) * len(centerline.points)
    at = index.astype(int)
    forward = centerline.points[at + 1] - centerline.points[at - 1]
    forward = forward / np.linalg.norm(forward, axis=1, keepdims=True)
    back = np.array([0.0, 0.0, -1.0])
    turn = np.column_stack([np.cross(np.broadcast_to(back, forward.shape), forward), 1.0 + forward @ back])
    turn[turn[:, 3] < 1.0e-6] = (1.0, 0.0, 0.0, 0.0)
    turn = turn / np.linalg.norm(turn, axis=1, keepdims=True)
    return np.column_stack([centerline.points[at], turn]).astype(np.float32)


def time_updates(
    stage: ColonStage, num_envs: int, size: int, device: str, samples: int = 1, repeats: int = 20
) -> dict[str, float]:
    """Time skinning with refit, drawing, and the whole update of one configuration.

    Args:
        stage: The colon.
        num_envs: Worlds.
        size: Edge length of the square picture [px].
        device: Device that draws.
        samples: Rays per pixel.
        repeats: Timed updates; the median counts.
    """
    scene: Any = RestingScene(stage, num_envs, device)
    camera = EndoscopeCamera(EndoscopeCameraCfg(width=size, height=size, samples=samples))
    camera.initialize(scene)

    update = median_ms(camera.update, device, repeats)
    draw = median_ms(camera.draw, device, repeats)
    skin = median_ms(lambda: camera.surface.update(scene["colon"].nodal_pos_wp), device, repeats)
    return {
        "num_envs": num_envs,
        "size": size,
        "samples": samples,
        "update_ms": round(update, 3),
        "draw_ms": round(draw, 3),
        "skin_and_refit_ms": round(skin, 3),
        "views_per_s": round(1.0e3 * num_envs / update, 1),
    }
