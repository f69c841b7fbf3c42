# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The capsule in the tiny colon, from rest, with small images: recorded once for all tests here."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest
import torch

import arcgym_tasks  # noqa: F401
from arcgym.envs import mdp
from arcgym.utils.registry import load_cfg_from_registry

TASK = "ARC-Splenic-Capsule"


def small_cfg(colon: Path, num_envs: int = 1) -> Any:
    cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    cfg.scene.num_envs, cfg.scene.colon.usd_path = num_envs, str(colon)
    cfg.scene.camera.width = cfg.scene.camera.height = 36
    cfg.start, cfg.seed, cfg.sim.device = "rest", 3, "cpu"
    return cfg


@pytest.fixture(scope="session")
def small(tiny_colon_path: Path) -> Callable[..., Any]:
    """Builds the environment."""
    return lambda **settings: gym.make(TASK, cfg=small_cfg(tiny_colon_path, **settings)).unwrapped


@pytest.fixture(scope="session")
def make_cfg(tiny_colon_path: Path) -> Callable[..., Any]:
    """Makes its configuration."""
    return lambda **settings: small_cfg(tiny_colon_path, **settings)


@pytest.fixture(scope="session")
def recorded(tiny_colon_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of two episodes of 14 steps, of two worlds with different friction, stiffness and actions."""
    folder = tmp_path_factory.mktemp("recorded")
    cfg = small_cfg(tiny_colon_path, num_envs=2)
    cfg.recorders = mdp.TrajectoryRecorderCfg(dataset_export_dir_path=str(folder))
    cfg.recorders.wall.positions = True
    cfg.recorders.observations = mdp.PreStepObservationsRecorderCfg()
    env = gym.make(TASK, cfg=cfg).unwrapped
    env.reset()
    torch.manual_seed(1)
    for _ in range(14):
        action = 2.0 * torch.rand(2, 6) - 1.0
        action[:, 2] = 1.0
        env.step(action)
    env.close()
    return folder
