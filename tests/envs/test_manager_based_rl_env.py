# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import dataclasses

import gymnasium as gym
import numpy as np
import pytest
import torch

from arcgym.envs import ManagerBasedEnv, ManagerBasedEnvCfg, ManagerBasedRLEnv, mdp
from arcgym.managers import CostTermCfg, MetricsTermCfg, reads_no_sensor
from arcgym.utils import MISSING, registry


def scatter(env, env_ids) -> None:
    position(env)[env_ids] = torch.rand(len(env_ids))


def position(env) -> torch.Tensor:
    return env.scene["counter"].position


def actions(*values: float) -> torch.Tensor:
    return torch.tensor(values).unsqueeze(1)


def test_step_moves_by_decimation_and_rewards_after_the_move(env) -> None:
    obs, reward, terminated, truncated, _ = env.step(actions(1.0, 2.0))
    # Two physics steps of 1 and 2; reward = weight 2 * position * 0.1 s.
    assert obs["critic"].tolist() == [[2.0, 1.0], [4.0, 2.0]]
    assert reward.tolist() == pytest.approx([0.4, 0.8])
    assert not terminated.any() and not truncated.any()


def test_world_that_ends_is_reset_and_the_other_goes_on(env) -> None:
    obs, reward, terminated, truncated, extras = env.step(actions(1.0, 4.0))
    assert terminated.tolist() == [False, True] and not truncated.any()
    assert obs["critic"].tolist() == [[2.0, 1.0], [0.0, 0.0]]
    assert reward.tolist() == pytest.approx([0.4, 1.6])
    assert env.episode_length_buf.tolist() == [1, 0] and env.num_done == 1
    assert extras["log"]["Episode_Termination/above"].item() == 1.0
    # Episode sum 1.6 over the longest episode of 0.5 s.
    assert extras["log"]["Episode_Reward/position"].item() == pytest.approx(3.2)


def test_only_worlds_that_are_reset_are_drawn_again(env) -> None:
    env.scene.drawn.clear()
    env.step(actions(1.0, 4.0))
    assert env.scene.drawn == [[0, 1], [1]]


@pytest.mark.parametrize("looks", [True, False])
def test_terminations_that_look_at_no_sensor_are_found_before_the_picture_is_drawn(cfg, looks) -> None:
    pictures_so_far = []

    def too_far(env, limit: float) -> torch.Tensor:
        pictures_so_far.append(len(env.scene.drawn))
        return position(env) > limit

    cfg.terminations["above"].func = too_far if looks else reads_no_sensor(too_far)
    cfg.terminations["time_out"].func = reads_no_sensor(mdp.time_out)
    env = ManagerBasedRLEnv(cfg)
    env.reset()
    before = len(env.scene.drawn)
    obs, reward, terminated, _, _ = env.step(actions(1.0, 4.0))
    assert pictures_so_far[-1] - before == (1 if looks else 0)
    assert terminated.tolist() == [False, True] and env.scene.drawn[before:] == [[0, 1], [1]]
    assert obs["policy"][:, -1, 0, 0].tolist() == [2, 0] and reward.tolist() == pytest.approx([0.4, 1.6])


def test_time_out_truncates(env) -> None:
    for _ in range(4):
        assert not env.step(actions(0.0, 0.1))[3].any()
    _, _, terminated, truncated, extras = env.step(actions(0.0, 0.1))
    assert not terminated.any() and truncated.all()
    assert extras["time_outs"].all()


def test_image_history_stacks_on_channels_and_starts_with_the_first_frame(env) -> None:
    obs, _ = env.reset()
    assert obs["policy"].dtype == torch.uint8 and obs["policy"].shape == (2, 9, 2, 2)
    env.step(actions(1.0, 1.0))
    obs = env.step(actions(1.0, 2.0))[0]
    assert obs["policy"][:, ::3, 0, 0].tolist() == [[0, 2, 4], [0, 2, 6]]
    obs = env.step(actions(0.0, 1.0))[0]  # World 1 reaches 8 and starts again at 0.
    assert obs["policy"][:, ::3, 0, 0].tolist() == [[2, 4, 4], [0, 0, 0]]


def test_observation_after_reset_equals_that_of_a_fresh_environment(cfg) -> None:
    used, fresh = ManagerBasedRLEnv(cfg), ManagerBasedRLEnv(cfg.copy())
    used.reset()
    for _ in range(3):
        used.step(actions(1.0, 0.5))
    for old, new in zip(used.reset()[0].values(), fresh.reset()[0].values(), strict=True):
        assert torch.equal(old, new)


def test_observations_are_not_overwritten_by_later_steps(env) -> None:
    kept = env.step(actions(1.0, 1.0))[0]
    copies = {name: value.clone() for name, value in kept.items()}
    env.step(actions(1.0, 1.0))
    assert all(torch.equal(kept[name], copies[name]) for name in kept)


def test_steps_in_inference_mode_may_be_followed_by_a_reset_outside(cfg) -> None:
    cfg.metrics = {"peak": MetricsTermCfg(func=position, reduce="max")}
    env = ManagerBasedRLEnv(cfg)
    env.reset()
    with torch.inference_mode():
        env.step(actions(1.0, 4.0))
    assert env.reset()[0]["critic"].tolist() == [[0.0, 0.0], [0.0, 0.0]]
    env.step(actions(1.0, 4.0))


def test_same_seed_gives_the_same_rollout(cfg) -> None:
    cfg.events["start"].func = scatter
    env = ManagerBasedRLEnv(cfg)
    first, second = (env.reset(seed=5)[0]["critic"][:, 0].tolist() for _ in range(2))
    assert first == second and first != env.reset(seed=6)[0]["critic"][:, 0].tolist()


def test_gymnasium_makes_a_registered_task(cfg) -> None:
    name = "Test-Counter"
    registry.register_task(name, env_cfg_entry_point="unused:Cfg")
    env = gym.make(name, cfg=cfg, render_mode="rgb_array")
    assert isinstance(env, ManagerBasedRLEnv) and env.unwrapped is env and env.spec.id == name
    assert env.reset(seed=1)[0]["policy"].shape == (2, 9, 2, 2)
    env.close()
    del gym.registry[name]


def test_base_environment_observes_and_acts_without_reward(cfg) -> None:
    names = [field.name for field in dataclasses.fields(ManagerBasedEnvCfg)]
    env = ManagerBasedEnv(ManagerBasedEnvCfg(**{name: getattr(cfg, name) for name in names}))
    env.reset()
    obs, extras = env.step(actions(1.0, 4.0))
    assert obs["critic"].tolist() == [[2.0, 1.0], [8.0, 4.0]] and extras == {"log": {}}


def test_non_finite_world_is_terminated_reset_and_counted(env) -> None:
    obs, reward, terminated, _, extras = env.step(actions(1.0, float("nan")))
    assert terminated.tolist() == [False, True]
    assert reward.tolist() == pytest.approx([0.4, 0.0])
    assert obs["critic"].tolist() == [[2.0, 1.0], [0.0, 0.0]]
    assert env.world_failures == 1
    assert extras["log"]["Episode_Termination/non_finite"].item() == 1.0


@pytest.mark.parametrize("shortage", [None, "9 contacts found no room"])
def test_contacts_without_room_are_told_when_the_environment_closes(env, caplog, shortage: str | None) -> None:
    env.sim.shortage = shortage
    env.close()
    assert [record.getMessage() for record in caplog.records] == ([shortage] if shortage else [])


def test_final_observation_is_that_before_the_reset(cfg) -> None:
    cfg.compute_final_obs = True
    env = ManagerBasedRLEnv(cfg)
    env.reset()
    assert "final_obs" not in env.step(actions(1.0, 1.0))[4]
    obs, *_, extras = env.step(actions(1.0, 3.0))  # World 1 goes from 2 to 8.
    assert extras["final_obs"]["critic"].tolist() == [[4.0, 1.0], [8.0, 3.0]]
    assert extras["final_obs"]["policy"][:, ::3, 0, 0].tolist() == [[0, 2, 4], [0, 2, 8]]
    assert obs["policy"][:, ::3, 0, 0].tolist() == [[0, 2, 4], [0, 0, 0]]


def test_costs_and_metrics_are_apart_from_the_reward(cfg) -> None:
    cfg.costs = {"position": CostTermCfg(func=position), "double": CostTermCfg(func=position, weight=2.0)}
    cfg.metrics = {"peak": MetricsTermCfg(func=position, reduce="max")}
    env = ManagerBasedRLEnv(cfg)
    env.reset()
    _, reward, _, _, extras = env.step(actions(1.0, 4.0))
    assert reward.tolist() == pytest.approx([0.4, 1.6])
    assert extras["cost"].tolist() == pytest.approx([0.6, 2.4])
    assert extras["costs"]["double"].tolist() == pytest.approx([0.4, 1.6])
    assert extras["log"]["Episode_Cost/position"].item() == pytest.approx(0.8)
    assert extras["log"]["Episode_Metrics/peak"].item() == 8.0


def test_rewards_per_step_leave_out_the_time(cfg) -> None:
    cfg.scale_rewards_by_dt = False
    env = ManagerBasedRLEnv(cfg)
    env.reset()
    assert env.step(actions(1.0, 2.0))[1].tolist() == [4.0, 8.0]


def test_spaces_hold_what_the_environment_returns(env) -> None:
    obs = env.step(torch.as_tensor(env.action_space.sample()) * 0.0)[0]
    assert env.single_observation_space["policy"] == gym.spaces.Box(0, 255, (9, 2, 2), np.uint8)
    assert env.action_space.shape == (2, 1)
    assert env.observation_space.contains({name: value.numpy() for name, value in obs.items()})


def test_seed_is_set_before_the_scene_is_built(cfg) -> None:
    cfg.seed = 123
    assert ManagerBasedRLEnv(cfg).scene.seed_at_build == 123


def test_missing_fields_are_named_before_anything_is_built(cfg) -> None:
    cfg.rewards = cfg.episode_length_s = MISSING
    cfg.scene.class_type = None
    with pytest.raises(ValueError, match="without a value: episode_length_s, rewards"):
        ManagerBasedRLEnv(cfg)


def test_episode_length_is_rounded_up_to_whole_steps(cfg) -> None:
    cfg.episode_length_s = 0.41
    assert ManagerBasedRLEnv(cfg).max_episode_length == 5


def test_wrong_action_shape_names_both(env) -> None:
    with pytest.raises(ValueError, match=r"shape \(2, 3\), expected \(2, 1\)"):
        env.step(torch.zeros(2, 3))


class OneColor:
    """A view that draws the world's index."""

    def __init__(self, env, cfg) -> None:
        self.size = cfg.samples

    def frame(self, env_id: int) -> np.ndarray:
        return np.full((self.size, self.size, 3), env_id, np.uint8)


def test_view_is_the_class_that_the_configuration_names(cfg) -> None:
    cfg.viewer.class_type, cfg.viewer.env_id, cfg.viewer.samples = OneColor, 1, 4
    env = ManagerBasedRLEnv(cfg, render_mode="rgb_array")
    assert env.render().shape == (4, 4, 3) and env.render().max() == 1
    assert ManagerBasedRLEnv(cfg).render() is None


def test_viewer_looks_at_a_world_that_exists(cfg) -> None:
    cfg.viewer.env_id = 2
    with pytest.raises(ValueError, match="viewer.env_id is 2, but scene.num_envs is 2"):
        ManagerBasedRLEnv(cfg)


def test_tables_list_every_manager(env) -> None:
    text = env.summary()
    assert "RewardManager (1 terms)" in text and "policy.rgb: (9, 2, 2) torch.uint8" in text
    assert "CurriculumManager" not in text  # It has no terms.
    assert str(env) == repr(env) == "ManagerBasedRLEnv(num_envs=2, device=cpu)"
