# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The counting environment through Gymnasium: make, make_vec, resets of some worlds, and its vector wrappers."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.wrappers import vector as wrappers

from arcgym.envs import ManagerBasedRLEnv, NumpyVectorEnv
from arcgym.managers import MetricsTermCfg, ObservationTermCfg, TerminationTermCfg
from arcgym.utils.registry import register_task

TASK = "Counter"


@pytest.fixture(autouse=True)
def registered(cfg):
    register_task(TASK, env_cfg_entry_point=type(cfg), rsl_rl_cfg_entry_point="nowhere:Cfg")  # type: ignore[arg-type]
    yield
    del gym.registry[TASK]


def column(*values: float) -> np.ndarray:
    return np.array(values)[:, None]


def test_make_honors_its_arguments() -> None:
    env = gym.make(TASK, num_envs=3, seed=7, device="cpu", render_mode="rgb_array")
    assert isinstance(env, ManagerBasedRLEnv) and isinstance(env, VectorEnv)
    assert (env.num_envs, env.cfg.seed, env.cfg.sim.device, env.render_mode) == (3, 7, "cpu", "rgb_array")
    assert str(env) == "ManagerBasedRLEnv(Counter, num_envs=3, device=cpu)"


def test_arguments_change_a_copy_of_the_configuration(cfg) -> None:
    assert gym.make(TASK, cfg=cfg).unwrapped.cfg is cfg
    assert gym.make(TASK, cfg=cfg, num_envs=3).unwrapped.cfg.scene.num_envs == 3
    assert cfg.scene.num_envs == 2


def test_unknown_argument_names_the_nearest_in_a_short_line(cfg) -> None:
    with pytest.raises(TypeError, match="no argument 'cgf'. Did you mean 'cfg'") as error:
        gym.make(TASK, cgf=cfg)
    assert str(error.value).endswith("Available: cfg, device, num_envs, render_mode, seed.")


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"num_envs": 0}, ValueError, "scene.num_envs is 0, expected 1 or more worlds"),
        ({"num_envs": 2.5}, TypeError, "^num_envs is 2.5 of type float, expected a whole number.$"),
        ({"seed": "a"}, TypeError, "^seed is 'a' of type str, expected a whole number.$"),
        ({"device": "tpu"}, ValueError, "The device is 'tpu'; this machine has cpu"),
        ({"device": "cuda:99"}, ValueError, "The device is 'cuda:99'; this machine has cpu"),
    ],
)
def test_wrong_arguments_are_named(arguments, error, message) -> None:
    with pytest.raises(error, match=message):
        gym.make(TASK, **arguments)


def test_class_in_place_of_a_configuration_is_named(cfg) -> None:
    with pytest.raises(TypeError, match="the class CounterEnvCfg; call it"):
        gym.make(TASK, cfg=type(cfg))


@pytest.mark.filterwarnings("ignore:.*that is not in the possible render_modes")
def test_unknown_render_mode_is_refused() -> None:
    with pytest.raises(ValueError, match="render_mode is 'ascii', expected None or one of rgb_array"):
        gym.make(TASK, render_mode="ascii")


def test_registered_configurations_have_a_common_ending() -> None:
    with pytest.raises(ValueError, match="names a configuration 'skrl', expected a name that ends in _cfg_entry_point"):
        register_task("Other", env_cfg_entry_point="a:B", skrl="c:D")


def test_make_vec_builds_one_environment_of_all_worlds() -> None:
    env = gym.make_vec(TASK, num_envs=3)
    assert isinstance(env, NumpyVectorEnv) and env.num_envs == 3
    assert env.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    assert env.single_action_space.shape == (1,) and env.action_space.shape == (3, 1)
    obs, infos = env.reset(seed=0)
    assert env.observation_space.contains(obs) and infos == {}
    assert env.unwrapped.np_random_seed == 0


def test_specification_of_an_environment_makes_it_again() -> None:
    assert gym.make(gym.make(TASK, num_envs=3).spec).num_envs == 3
    assert gym.make_vec(gym.make_vec(TASK, num_envs=3).spec).num_envs == 3


def test_make_vec_returns_the_environment_itself_on_request() -> None:
    env = gym.make_vec(TASK, num_envs=3, to_numpy=False)
    assert isinstance(env, ManagerBasedRLEnv)
    assert isinstance(env.reset()[0]["critic"], torch.Tensor)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_numpy_actions_move_as_torch_ones(env, dtype) -> None:
    obs = env.step(column(1.0, 2.0).astype(dtype))[0]
    assert obs["critic"].tolist() == [[2.0, 1.0], [4.0, 2.0]]


@pytest.mark.parametrize("options", [{"env_ids": [1]}, {"reset_mask": np.array([False, True])}])
def test_reset_of_some_worlds_leaves_the_others(env, options) -> None:
    """Both worlds were at 2 and at 4; world 1 starts again, world 0 keeps its position, action and images."""
    for _ in range(2):
        env.step(column(1.0, 1.0))
    obs, _ = env.reset(options=options)
    assert obs["critic"].tolist() == [[4.0, 1.0], [0.0, 0.0]]
    assert obs["policy"][:, ::3, 0, 0].tolist() == [[0, 2, 4], [0, 0, 0]]
    assert env.episode_length_buf.tolist() == [2, 0]
    obs = env.step(column(1.0, 1.0))[0]
    assert obs["policy"][:, ::3, 0, 0].tolist() == [[2, 4, 6], [0, 0, 2]]


def test_reset_of_some_worlds_keeps_delayed_observations(cfg) -> None:
    """Two steps late: world 0 goes on seeing 0, 2, 4, ...; world 1 sees its new start until it is two steps old."""
    late = ObservationTermCfg(func=lambda env: env.scene["counter"].position[:, None], delay_min_lag=2, delay_max_lag=2)
    cfg.observations.critic.position = late
    env = ManagerBasedRLEnv(cfg)
    env.reset()
    seen = [env.step(column(1.0, 1.0))[0]["critic"][:, 0].tolist() for _ in range(2)]
    seen.append(env.reset(options={"env_ids": [1]})[0]["critic"][:, 0].tolist())
    seen += [env.step(column(0.5, 0.5))[0]["critic"][:, 0].tolist() for _ in range(2)]
    assert seen == [[0, 0], [0, 0], [0, 0], [2, 0], [4, 0]]


def test_no_world_named_is_no_reset(env) -> None:
    before = env.step(column(1.0, 1.0))[0]["critic"].tolist()
    assert env.reset(options={"env_ids": []})[0]["critic"].tolist() == before


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"env_id": [0]}, ValueError, "no option 'env_id'. Did you mean 'env_ids'"),
        ({"env_ids": [2]}, IndexError, r"env_ids are \[2\]; worlds go from 0 to 1"),
        ({"reset_mask": [True]}, ValueError, r"torch.bool of shape \(1,\), expected torch.bool of shape \(2,\)"),
        ({"env_ids": [0], "reset_mask": [True, False]}, ValueError, "both env_ids and reset_mask"),
        ({"env_ids": np.array([False, True])}, TypeError, "env_ids are torch.bool, expected whole numbers.*reset_mask"),
        ({"env_ids": [0.0, 1.0]}, TypeError, "env_ids are torch.float32, expected whole numbers"),
    ],
)
def test_malformed_options_are_named(env, options, error, message) -> None:
    with pytest.raises(error, match=message):
        env.reset(options=options)


def test_worlds_cannot_be_reset_before_all_have_started(cfg) -> None:
    with pytest.raises(gym.error.ResetNeeded, match="call reset"):
        ManagerBasedRLEnv(cfg).reset(options={"env_ids": [0]})


def test_final_observations_and_infos_are_those_of_gymnasium(cfg) -> None:
    """World 1 makes two steps of 2 and 6 and ends at 8, above 7; its metric is the mean of 2 and 8."""
    cfg.metrics = {"position": MetricsTermCfg(func=lambda env: env.scene["counter"].position)}
    cfg.terminations["above"].success = True
    env = NumpyVectorEnv(ManagerBasedRLEnv(cfg))
    env.reset()
    assert "final_obs" not in env.step(column(1.0, 1.0))[4]
    obs, _, terminated, _, infos = env.step(column(1.0, 3.0))
    assert terminated.tolist() == infos["_final_obs"].tolist() == infos["_final_info"].tolist() == [False, True]
    assert infos["final_obs"][0] is None
    assert infos["final_obs"][1]["critic"].tolist() == [8.0, 3.0] and obs["critic"][1].tolist() == [0.0, 0.0]
    final = infos["final_info"]
    assert (final["success"][1], final["episode_length"][1], final["metrics"]["position"][1]) == (True, 2, 5.0)


def test_without_autoreset_worlds_wait_for_their_reset(cfg) -> None:
    """World 1 passes 7 and stays where it is until it is reset by hand."""
    cfg.autoreset = False
    env = NumpyVectorEnv(ManagerBasedRLEnv(cfg))
    assert env.metadata["autoreset_mode"] is AutoresetMode.DISABLED
    env.reset()
    obs, _, terminated, truncated, _ = env.step(column(1.0, 4.0))
    assert obs["critic"][:, 0].tolist() == [2.0, 8.0] and terminated.tolist() == [False, True]
    obs, _ = env.reset(options={"reset_mask": terminated | truncated})
    assert obs["critic"][:, 0].tolist() == [2.0, 0.0]


def test_record_episode_statistics() -> None:
    """World 1 earns 0.1 s x 2 x (2 + 8) in two steps."""
    env = wrappers.RecordEpisodeStatistics(gym.make_vec(TASK, num_envs=2))
    env.reset(seed=0)
    env.step(column(1.0, 1.0))
    infos = env.step(column(1.0, 3.0))[4]
    assert infos["_episode"].tolist() == [False, True]
    assert infos["episode"]["r"][1] == pytest.approx(2.0) and infos["episode"]["l"][1] == 2


def test_wrappers_of_actions_rewards_and_infos() -> None:
    env = gym.make_vec(TASK, num_envs=2)
    env = wrappers.TransformAction(env, lambda action: 2.0 * action)
    env = wrappers.DictInfoToList(wrappers.ClipReward(env, 0.0, 0.5))
    env.reset()
    obs, reward, *_, infos = env.step(column(1.0, 2.0))
    assert obs["critic"][:, 0].tolist() == [4.0, 0.0] and reward.tolist() == pytest.approx([0.5, 0.5])
    assert "final_obs" not in infos[0] and infos[1]["final_obs"]["critic"].tolist() == [8.0, 4.0]


def test_normalize_reward_and_numpy_to_torch() -> None:
    env = wrappers.NumpyToTorch(wrappers.NormalizeReward(gym.make_vec(TASK, num_envs=2)))
    obs, _ = env.reset(seed=0)
    assert obs["policy"].dtype == torch.uint8
    assert env.step(torch.ones(2, 1))[1].shape == (2,)


def test_observation_wrappers_take_environments_without_autoreset(cfg) -> None:
    cfg.autoreset = False
    env = wrappers.FilterObservation(gym.make_vec(TASK, num_envs=2, cfg=cfg), ["critic"])
    env = wrappers.FlattenObservation(env)
    assert env.reset()[0].shape == (2, 2)


def test_wrappers_of_single_environments_work_too() -> None:
    env = gym.wrappers.TransformReward(gym.make(TASK), lambda reward: -reward)
    env.reset()
    assert env.step(column(1.0, 2.0))[1].tolist() == pytest.approx([-0.4, -0.8])


def test_videos_of_all_worlds(monkeypatch) -> None:
    monkeypatch.setattr(ManagerBasedRLEnv, "render_world", lambda self, world: np.full((2, 2, 3), world, np.uint8))
    env = gym.make_vec(TASK, num_envs=2, render_mode="rgb_array")
    assert [frame[0, 0, 0] for frame in env.render()] == [0, 1]
    assert gym.make_vec(TASK, num_envs=2).render() is None
    assert gym.make(TASK, render_mode="rgb_array").render().max() == 0


def test_environment_closes_once_and_as_a_context(cfg) -> None:
    with gym.make(TASK) as env:
        env.reset()
    env.close()
    assert env.unwrapped.closed
    with pytest.raises(gym.error.ClosedEnvironmentError, match="Counter.*is closed"):
        env.step(column(1.0, 1.0))
    again = gym.make(TASK)
    assert again.reset()[0]["critic"].tolist() == [[0.0, 0.0], [0.0, 0.0]]


def test_done_terms_may_be_replaced_through_the_configuration(cfg) -> None:
    cfg.terminations["above"] = TerminationTermCfg(func=lambda env: env.scene["counter"].position > 1.0)
    env = gym.make(TASK, cfg=cfg)
    env.reset()
    assert env.step(column(1.0, 0.1))[2].tolist() == [True, False]
