#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What the lumen reward is worth: its mean over camera poses along a colon, by viewing angle and distance to the wall.

A capsule is put on the centerline at evenly spaced places and turned away from the lumen, or brought up to the wall;
nothing moves. One row a view, for each preset of the reward's constants.
"""

from __future__ import annotations

import argparse
import math

import torch

from arcgym.assets import CAPSULE_CFG, ColonCfg
from arcgym.envs.mdp import LUMEN_PRESETS, score_depth
from arcgym.scene import InteractiveScene, InteractiveSceneCfg
from arcgym.sensors import EndoscopeCameraCfg
from arcgym.sim import SimulationCfg
from arcgym.utils.math import normalize, quat_from_matrix

AHEAD = 0.03
"""Arc length ahead at which a well aimed camera looks [m]."""


def main() -> None:
    """Parse the arguments and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--colon", default="colon_1/colon.usda", help="stage of the colon")
    parser.add_argument("--poses", type=int, default=64, help="places along the colon")
    parser.add_argument("--start", type=float, default=0.05, help="first place, arc length [m]")
    parser.add_argument("--end", type=float, default=1.0, help="last place, arc length [m]")
    parser.add_argument("--device", default="cpu")
    args = parser.parse_args()
    cfg = InteractiveSceneCfg(
        num_envs=args.poses,
        colon=ColonCfg(usd_path=args.colon),
        endoscope=CAPSULE_CFG,
        camera=EndoscopeCameraCfg(),
    )
    scene = InteractiveScene(cfg, SimulationCfg(device=args.device))
    scene.sim.forward()
    place, forward, sideways = course(scene, args.start, args.end)
    presets = "".join(f"{name + ' R (s_c, s_o)':>30s}" for name in LUMEN_PRESETS)
    print(f"{'view':18s}{presets}   d_max  contrast [mm]")
    for degrees in (0, 15, 30, 45, 60, 90):
        angle = math.radians(degrees)
        look = math.cos(angle) * forward + math.sin(angle) * sideways
        report(f"{degrees} deg off", photograph(scene, place, look, forward))
    axis_depth = photograph(scene, place, sideways, forward)
    rows, columns = (size // 2 for size in axis_depth.shape[1:])
    wall = axis_depth[:, rows, columns]
    for distance in (0.012, 0.006, 0.003):
        near = place + (wall - distance)[:, None] * sideways
        report(f"wall at {1e3 * distance:.0f} mm", photograph(scene, near, sideways, forward))


def course(scene: InteractiveScene, start: float, end: float) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Return places on the centerline [m], unit directions along the lumen and across it, each (N, 3)."""
    data = scene["colon"].data
    arc = data.centerline_arc
    wanted = torch.linspace(start, end, scene.num_envs, device=scene.device)
    here, there = (torch.searchsorted(arc, at).clamp(max=len(arc) - 1) for at in (wanted, wanted + AHEAD))
    place = data.centerline_pos_w[0, here]
    forward = normalize(data.centerline_pos_w[0, there] - place)
    torch.manual_seed(0)
    return place, forward, normalize(torch.linalg.cross(forward, torch.randn_like(forward)))


def photograph(scene: InteractiveScene, eye: torch.Tensor, look: torch.Tensor, hint: torch.Tensor) -> torch.Tensor:
    """Return the depth [m], shape (N, H, W), of cameras that look along ``look``; ``hint`` settles the roll."""
    across = normalize(torch.linalg.cross(hint + 0.1 * torch.roll(look, 1, dims=1), look))
    frame = torch.stack((across, torch.linalg.cross(look, across), look), dim=2)
    endoscope = scene["endoscope"]
    endoscope.data.joint_pos[:, :3] = eye - endoscope.stage.camera.position[2] * look
    endoscope.data.joint_pos[:, 3:7] = quat_from_matrix(frame)
    scene.sim.forward()
    scene.update(0.0)
    return scene["camera"].data.output["depth"].clone()


def report(view: str, depth: torch.Tensor) -> None:
    """Print one row."""
    line = f"{view:18s}"
    for preset in LUMEN_PRESETS.values():
        scores = score_depth(depth, preset)
        means = [float(value.mean()) for value in (scores.reward, scores.s_c, scores.s_o)]
        line += f"{means[0]:14.2f} ({means[1]:5.2f}, {means[2]:5.2f})"
    far, near = depth.amax(dim=(1, 2)), depth.amin(dim=(1, 2))
    print(line + f"{1e3 * float(far.median()):8.0f} {1e3 * float((far - near).median()):9.0f}")


if __name__ == "__main__":
    main()
