# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw what the policy sees in each variant of a task that spoils its picture.

python scripts/tools/robustness_plot.py docs/images/robustness.jpg
"""

from __future__ import annotations

import sys

import gymnasium as gym
import torch
from matplotlib.figure import Figure

import arcgym_tasks  # noqa: F401
from arcgym.rl.expert_policy import ExpertPolicy
from arcgym.utils.registry import load_cfg_from_registry
from arcgym_tasks.navigation.robustness import LIGHTS, NONE, PICTURES

TASK = "ARC-LeftColon-Capsule"
STEPS = 45
"""Control steps that the expert makes first."""


def newest_picture(variant: str) -> torch.Tensor:
    """Return the policy's newest picture after some steps of the expert, uint8, shape (H, W, 3)."""
    cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    cfg.scene.num_envs, cfg.sim.device, cfg.seed, cfg.robustness = 1, "cpu", 3, variant
    cfg.scene.camera.width = cfg.scene.camera.height = 168
    env = gym.make(TASK, cfg=cfg).unwrapped
    env.reset()
    policy = ExpertPolicy(env)
    for _ in range(STEPS):
        obs = env.step(policy())[0]
    env.close()
    return obs["policy"][0, -3:].permute(1, 2, 0)


def main(path: str) -> None:
    """Draw a row a kind, a column a strength."""
    kinds = [*PICTURES, *LIGHTS]
    kinds.remove("dropped")
    figure = Figure(figsize=(1.35 * (len(kinds) + 1), 4.4), layout="constrained")
    axes = figure.subplots(3, len(kinds) + 1)
    plain = newest_picture(NONE)
    for row in range(3):
        axes[row, 0].imshow(plain)
        axes[row, 0].set_ylabel(f"strength {row + 1}")
        for column, kind in enumerate(kinds, start=1):
            axes[row, column].imshow(newest_picture(f"{kind}_{row + 1}"))
            axes[0, column].set_title(kind)
    axes[0, 0].set_title("plain")
    for one in axes.flat:
        one.set(xticks=[], yticks=[])
    figure.savefig(path, dpi=80)


if __name__ == "__main__":
    main(sys.argv[1])
