# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The examples of docs/other_libraries.md, run as they stand, and the adapter to Stable-Baselines3."""

from __future__ import annotations

import re
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

from arcgym.envs import ManagerBasedRLEnv
from arcgym.rl.sb3 import Sb3VecEnv
from arcgym.utils.registry import register_task

PAGE = Path(__file__).parents[2] / "docs" / "other_libraries.md"
EXAMPLES = re.findall(r"^## ([^\n]+)\n(?:(?!^## ).)*?```python\n(.*?)```", PAGE.read_text(), re.DOTALL | re.MULTILINE)
TASK = "ARC-Rectum-Capsule"


@pytest.fixture
def counter_task(cfg):
    """The counting environment with images of 40 px, as a task."""
    cfg.scene.image_size = 40
    register_task("Counter", env_cfg_entry_point=cfg)
    yield "Counter"
    del gym.registry["Counter"]


def test_page_has_an_example_for_each_library() -> None:
    assert [title for title, _ in EXAMPLES] == [
        "Plain torch",
        "Gymnasium's vector wrappers",
        "Stable-Baselines3",
        "skrl",
    ]


@pytest.mark.parametrize(("title", "code"), EXAMPLES, ids=[title for title, _ in EXAMPLES])
def test_example_runs(title, code, counter_task, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert code.count(TASK) == 1
    exec(compile(code.replace(TASK, counter_task), f"{PAGE.name}: {title}", "exec"), {"__name__": "example"})


@pytest.mark.slow
@pytest.mark.parametrize(("title", "code"), EXAMPLES, ids=[title for title, _ in EXAMPLES])
def test_example_runs_with_its_task(title, code, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(code, f"{PAGE.name}: {title}", "exec"), {"__name__": "example"})


@pytest.fixture
def sb3(cfg) -> Sb3VecEnv:
    return Sb3VecEnv(ManagerBasedRLEnv(cfg))


def column(*values: float) -> np.ndarray:
    return np.array(values, np.float32)[:, None]


def test_spaces_are_images_of_bytes_and_bounded_actions(sb3) -> None:
    assert sb3.observation_space == gym.spaces.Box(0, 255, (9, 2, 2), np.uint8)
    assert sb3.action_space == gym.spaces.Box(-1.0, 1.0, (1,), np.float32)


def test_last_observation_of_an_episode_is_in_the_infos(sb3) -> None:
    """World 1 goes from 0 to 8, above 7: the picture after the step is that of its new start."""
    sb3.reset()
    obs, rewards, dones, infos = sb3.step(column(1.0, 4.0))
    assert dones.tolist() == [False, True] and rewards.tolist() == pytest.approx([0.4, 1.6])
    assert obs[:, -1, 0, 0].tolist() == [2, 0] and infos[0] == {}
    assert infos[1].pop("terminal_observation")[-1, 0, 0] == 8
    assert infos[1] == {"TimeLimit.truncated": False, "is_success": False}


@pytest.mark.parametrize("is_finite_horizon", [False, True])
def test_time_outs_are_bootstrapped_unless_the_horizon_is_part_of_the_task(cfg, is_finite_horizon) -> None:
    cfg.is_finite_horizon = is_finite_horizon
    env = Sb3VecEnv(ManagerBasedRLEnv(cfg))
    env.reset()
    for _ in range(5):
        _, _, dones, infos = env.step(column(0.0, 0.0))
    assert dones.all() and infos[0]["TimeLimit.truncated"] is not is_finite_horizon


def test_several_groups_are_a_dict_and_unknown_ones_are_named(cfg) -> None:
    env = ManagerBasedRLEnv(cfg)
    assert set(Sb3VecEnv(env, group=("policy", "critic")).reset()) == {"policy", "critic"}
    with pytest.raises(KeyError, match="no observation group 'image'. Available: .*policy"):
        Sb3VecEnv(env, group="image")


def test_seed_reaches_the_environment(sb3) -> None:
    sb3.seed(11)
    sb3.reset()
    assert sb3.env.unwrapped.np_random_seed == 11


def test_worlds_must_start_again_by_themselves(cfg) -> None:
    cfg.autoreset = False
    with pytest.raises(ValueError, match="leave env.autoreset at True"):
        Sb3VecEnv(ManagerBasedRLEnv(cfg))
