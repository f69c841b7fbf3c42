#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw one view of the descending colon without and with each effect of the camera's chain.

python scripts/tools/camera_plot.py docs/images/camera_chain.jpg
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from PIL import Image, ImageDraw

from arcgym.experts import PushExpert
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import load_cfg_from_registry

TASK = "ARC-Descending-Proximal"
SIZE = 200
STEPS = 20
TURN = 0.6
"""Bending that is added in the last control step [rad]: a quick turn."""
EFFECTS = ("light", "latency", "exposure")


def main() -> None:
    """Draw and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture", type=Path, help="picture to write (.jpg)")
    args = parser.parse_args()
    views = [("as shipped", view())] + [(f"{name}", view(f"env.clinical=[{name}]")) for name in EFFECTS]
    views += scored()
    sheet = Image.new("RGB", (4 * SIZE, 2 * SIZE))
    for number, (title, picture) in enumerate(views):
        image = Image.fromarray(picture)
        ImageDraw.Draw(image).text((6, SIZE - 16), title, fill="white", stroke_width=2, stroke_fill="black")
        sheet.paste(image, (SIZE * (number % 4), SIZE * (number // 4)))
    sheet.save(args.picture, quality=80)


def view(*overrides: str) -> np.ndarray:
    """Return the picture after a quick turn."""
    env = driven(*overrides)
    turn(env)
    picture = shown(env)
    env.close()
    return picture


def scored() -> list[tuple[str, np.ndarray]]:
    """Return the picture at each preparation score."""
    env, views = driven("env.clinical=[preparation]"), []
    turn(env)
    for score in (3, 2, 1, 0):
        camera = env.scene["camera"]
        camera.write_preparation(torch.full((1, 3), score), torch.tensor([5]))
        camera.update()
        views.append((f"preparation, score {score}", shown(env)))
    env.close()
    return views


def driven(*overrides: str) -> Any:
    """Return a world in which the expert has driven on from the start of the segment."""
    cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    apply_overrides({"env": cfg}, list(overrides))
    cfg.scene.num_envs, cfg.scene.camera.samples = 1, 4
    cfg.scene.camera.width = cfg.scene.camera.height = SIZE
    for name in ("patient", "aim", "light", "color", "texture", "stiffness", "friction"):
        setattr(cfg.events, name, None)
    env = gym.make(TASK, cfg=cfg, seed=0).unwrapped
    env.reset()
    expert = PushExpert(env.scene, speed=0.03)
    for _ in range(STEPS):
        expert.act()
        advance(env)
    return env


def turn(env: Any) -> None:
    """Make a control step with a quick turn."""
    scope = env.scene["endoscope"]
    pitch, yaw = scope.data.bending.clone().unbind(dim=1)
    scope.set_bending_command(pitch, yaw + TURN)
    advance(env)


def advance(env: Any) -> None:
    """Make a control step."""
    env.sim.step(env.cfg.decimation)
    env.scene.update(env.step_dt)


def shown(env: Any) -> np.ndarray:
    """Return a copy of the policy's picture."""
    return np.asarray(env.scene["camera"].data.output["rgb"][0].cpu().numpy()).copy()


if __name__ == "__main__":
    main()
