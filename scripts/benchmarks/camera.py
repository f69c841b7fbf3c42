# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how many pictures the endoscope camera draws in a second, without any physics.

Every world gets its own copy of a colon at rest and a camera on its centreline. One update skins the surface, refits
the ray tree and draws colour and depth. Run for example::

    python scripts/benchmarks/camera.py --device cuda:0 --num_envs 1 64 256 1024 --size 64 84 128 --json
"""

from __future__ import annotations

import argparse
import json
from typing import Any

import numpy as np
from _common import full_name, median_ms


def parse_args() -> argparse.Namespace:
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--colon", default="colon_1/colon.usda", help="stage of the colon (file, or inside assets)")
    parser.add_argument("--device", default="cpu", help="cpu or cuda:0")
    parser.add_argument("--num_envs", type=int, nargs="+", default=[1, 4], help="numbers of worlds")
    parser.add_argument("--size", type=int, nargs="+", default=[84], help="edge lengths of the square picture [px]")
    parser.add_argument("--samples", type=int, default=1, help="rays per pixel")
    parser.add_argument("--repeats", type=int, default=20, help="timed updates; the median counts")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object on the last line")
    return parser.parse_args()


class RestingScene(dict):
    """As much of a scene as the camera needs: colons at rest, and cameras along their centrelines."""

    def __init__(self, stage: Any, num_envs: int, device: str) -> None:
        """Copies the colon into `num_envs` worlds and spreads the cameras over its length."""
        from types import SimpleNamespace

        import warp as wp

        from arcgym.assets.endoscope_spec import CameraSpec

        super().__init__()
        self.num_envs, self.device = num_envs, device
        nodes = np.repeat(stage.wall.points[:, None], num_envs, axis=1)
        optics = SimpleNamespace(
            camera=CameraSpec(position=(0.0, 0.0, 0.0)), lights=np.array([[-0.004, 0.001, 0.0], [0.004, 0.001, 0.0]])
        )
        poses = centerline_poses(stage.centerline, num_envs)
        self["colon"] = SimpleNamespace(
            stage=stage, wall=stage.wall, nodal_pos_wp=wp.array(nodes, dtype=wp.vec3, device=device)
        )
        self["endoscope"] = SimpleNamespace(
            stage=optics, camera_pose_wp=wp.array(poses, dtype=wp.transform, device=device)
        )


def centerline_poses(centerline: Any, count: int) -> np.ndarray:
    """Camera poses spread over the middle of the colon, looking along it, shape (count, 7), float32."""
    index = np.linspace(0.1, 0.8, count) * len(centerline.points)
    at = index.astype(int)
    forward = centerline.points[at + 1] - centerline.points[at - 1]
    forward = forward / np.linalg.norm(forward, axis=1, keepdims=True)
    back = np.array([0.0, 0.0, -1.0])
    turn = np.column_stack([np.cross(np.broadcast_to(back, forward.shape), forward), 1.0 + forward @ back])
    turn[turn[:, 3] < 1.0e-6] = (1.0, 0.0, 0.0, 0.0)
    turn = turn / np.linalg.norm(turn, axis=1, keepdims=True)
    return np.column_stack([centerline.points[at], turn]).astype(np.float32)


def time_updates(stage: Any, num_envs: int, size: int, args: argparse.Namespace) -> dict[str, float]:
    """Times skinning with refit, drawing, and the whole update of one configuration."""
    from arcgym.sensors import EndoscopeCamera, EndoscopeCameraCfg

    scene = RestingScene(stage, num_envs, args.device)
    camera = EndoscopeCamera(EndoscopeCameraCfg(width=size, height=size, samples=args.samples))
    camera.initialize(scene)

    update = median_ms(camera.update, args.device, args.repeats)
    draw = median_ms(camera.draw, args.device, args.repeats)
    skin = median_ms(lambda: camera.surface.update(scene["colon"].nodal_pos_wp), args.device, args.repeats)
    return {
        "num_envs": num_envs,
        "size": size,
        "samples": args.samples,
        "update_ms": round(update, 3),
        "draw_ms": round(draw, 3),
        "skin_and_refit_ms": round(skin, 3),
        "views_per_s": round(1.0e3 * num_envs / update, 1),
    }


def main() -> None:
    """Runs every combination of world count and picture size."""
    args = parse_args()
    from arcgym.anatomy import read_colon
    from arcgym.utils.paths import resolve_asset

    stage = read_colon(resolve_asset(args.colon))
    results = []
    for num_envs in args.num_envs:
        for size in args.size:
            results.append(time_updates(stage, num_envs, size, args))
            print("  ".join(f"{key} {value}" for key, value in results[-1].items()))
    if args.json:
        print(
            json.dumps(
                {"benchmark": "camera", "colon": args.colon, "device": full_name(args.device), "results": results}
            )
        )


if __name__ == "__main__":
    main()
