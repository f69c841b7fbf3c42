# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import gymnasium as gym
import pytest
import torch
from rsl_rl.utils import resolve_callable

from arcgym.cli.task import agent_key
from arcgym.rl import RslRlVecEnvWrapper, constrained_runner
from arcgym.rl.agent_checks import check_agent
from arcgym.utils.errors import UsageError
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import list_tasks, load_cfg_from_registry
from arcgym.utils.threads import one_thread

TASK = "ARC-Rectum-Magnetic"
KEYS = (
    "ppo",
    "ppo_recurrent",
    "ppo_masked",
    "ppo_lagrangian",
    "ppo_predicting",
    "ppo_bounded",
    "a2c",
    "sac",
    "sac_squint",
    "sac_paper",
    "ppo_teacher",
    "ppo_teacher_rgb",
)
"""Agents that learn from the environment alone."""


def make_runner(key: str, counting_env, monkeypatch):
    counting_env.image = torch.zeros(2, 15, 84, 84, dtype=torch.uint8)
    monkeypatch.setattr(constrained_runner, "action_axes", lambda env: ("pitch", "yaw"))
    monkeypatch.setattr(constrained_runner, "make_depth", lambda env, cfg: lambda: torch.ones(2, 5, 5))
    cfg = load_cfg_from_registry(TASK, agent_key(key)).replace(num_steps_per_env=4)
    if hasattr(cfg.algorithm, "replay_size"):
        cfg.algorithm.replay_size, cfg.algorithm.learning_starts, cfg.algorithm.batch_size = 64, 8, 4
    if hasattr(cfg.algorithm, "num_mini_batches"):
        cfg.algorithm.num_mini_batches = min(cfg.algorithm.num_mini_batches, 2)
    return resolve_callable(cfg.class_name)(RslRlVecEnvWrapper(counting_env), cfg.to_dict(), device="cpu")


@pytest.mark.parametrize("key", KEYS)
@one_thread()
def test_agent_learns_and_acts(key, counting_env, monkeypatch):
    step = counting_env.step

    def step_with_costs(action):
        obs, reward, terminated, truncated, extras = step(action)
        extras["costs"] = {"tip_force": torch.zeros(2), "view_blocked": torch.ones(2)}
        extras["final_obs"] = counting_env._obs()
        return obs, reward, terminated, truncated, extras

    counting_env.step = step_with_costs
    runner = make_runner(key, counting_env, monkeypatch)
    runner.learn(2)
    policy = runner.get_inference_policy()
    policy.reset()
    with torch.inference_mode():
        assert policy(runner.env.get_observations()).shape == (2, 2)


def test_every_task_has_every_agent():
    """Those that learn from the environment, and those that need a teacher or recordings."""
    for task in list_tasks():
        keys = (*KEYS, "distillation", "distillation_recurrent", "distillation_rgb", "ppo_taught", "bc")
        assert {agent_key(key) for key in keys} <= set(gym.registry[task].kwargs)


@pytest.mark.parametrize(
    ("key", "model"), [("distillation", "actor"), ("distillation_recurrent", "critic"), ("bc", "critic")]
)
def test_a_network_that_an_agent_does_not_have_cannot_be_set(key: str, model: str) -> None:
    """Otherwise ``agent.actor.hidden_dims=[64]`` would say nothing and change nothing for a student."""
    cfg = load_cfg_from_registry(TASK, agent_key(key))
    with pytest.raises(ValueError, match=f"'agent.{model}' is switched off"):
        apply_overrides({"agent": cfg}, [f"agent.{model}.hidden_dims=[64]"])


def test_each_agent_has_a_folder_of_its_own():
    names = {key: load_cfg_from_registry(TASK, agent_key(key)).experiment_name for key in KEYS}
    assert names["ppo"] == "arc_rectum_magnetic"
    assert names["sac"] == "arc_rectum_magnetic_sac"
    assert len(set(names.values())) == len(KEYS)


def test_limits_are_costs_of_the_task():
    limits = load_cfg_from_registry(TASK, agent_key("ppo_lagrangian")).algorithm.limits
    costs = load_cfg_from_registry(TASK, "env_cfg_entry_point").costs
    assert all(getattr(costs, name) is not None for name in limits)


def test_frame_stacks_are_those_of_the_task():
    stacks = load_cfg_from_registry(TASK, agent_key("sac")).algorithm.frame_stacks
    policy = load_cfg_from_registry(TASK, "env_cfg_entry_point").observations.policy
    assert stacks == {"policy": policy.rgb.history_length}


def test_images_among_the_further_terms_of_a_group_are_checked() -> None:
    """The camera of 20 px is as much too small in ``terms`` as it is in a member."""
    env_cfg, agent_cfg = (load_cfg_from_registry(TASK, key) for key in ("env_cfg_entry_point", agent_key("ppo")))
    env_cfg.scene.camera.width = env_cfg.scene.camera.height = 20
    policy = env_cfg.observations.policy
    policy.terms, policy.rgb = {"picture": policy.rgb}, None
    with pytest.raises(UsageError, match="does not fit the 20x20 px images"):
        check_agent(env_cfg, agent_cfg, trains=False)


@pytest.mark.parametrize(("extra", "fits"), [(("force",), True), ((), False)])
def test_groups_that_a_task_adds_are_there_for_the_agent(extra: tuple[str, ...], fits: bool) -> None:
    """As ``env.extra_observations=[force] agent.obs_groups.actor=[policy,force]``; the given configuration stays."""
    env_cfg, agent_cfg = (load_cfg_from_registry(TASK, key) for key in ("env_cfg_entry_point", agent_key("ppo")))
    env_cfg.extra_observations, agent_cfg.obs_groups["actor"] = extra, ["policy", "force"]
    if fits:
        check_agent(env_cfg, agent_cfg, trains=True)
    else:
        with pytest.raises(UsageError, match=r"agent\.obs_groups\.actor reads 'force', which is no observation group"):
            check_agent(env_cfg, agent_cfg, trains=True)
    assert env_cfg.observations.force is None
