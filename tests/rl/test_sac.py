# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import math

import pytest
import torch
from pixel_tasks import SteerToDot, mean_reward
from small_agents import ENCODER
from tensordict import TensorDict

from arcgym.rl import export_policy_as_jit, export_policy_as_onnx
from arcgym.rl.agent_cfgs.image_models import AugmentedCnnModelCfg
from arcgym.rl.agent_cfgs.sac import (
    CnnQModelCfg,
    MlpQModelCfg,
    RslRlSacAlgorithmCfg,
    RslRlSacRunnerCfg,
    SquashedGaussianDistributionCfg,
)
from arcgym.rl.off_policy_runner import OffPolicyRunner
from arcgym.rl.replay import ReplayBatch
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread


def runner_cfg(algorithm: dict | None = None, **changes) -> RslRlSacRunnerCfg:
    settings = {"replay_size": 20_000, "learning_starts": 256, "batch_size": 128, "gamma": 0.8, "learning_rate": 1e-3}
    actor = AugmentedCnnModelCfg(
        hidden_dims=[32], cnn_cfg=ENCODER, shift=1, distribution_cfg=SquashedGaussianDistributionCfg()
    )
    critic = MlpQModelCfg(hidden_dims=[32], obs_normalization=True)
    algorithm_cfg = RslRlSacAlgorithmCfg(**(settings | (algorithm or {})))
    defaults = {"actor": actor, "critic": critic, "algorithm": algorithm_cfg, "num_steps_per_env": 8}
    return RslRlSacRunnerCfg(**(defaults | changes))


def make_runner(num_envs: int = 8, log_dir=None, seed: int = 0, **changes) -> OffPolicyRunner:
    torch.manual_seed(seed)
    env = SteerToDot(num_envs)
    env.cfg.compute_final_obs = False
    return OffPolicyRunner(env, runner_cfg(**changes).to_dict(), log_dir=log_dir, device="cpu")


def make_batch(terminated: list[float], gamma: float = 0.8) -> ReplayBatch:
    env = SteerToDot(len(terminated))
    obs = env.get_observations()
    ones = torch.ones(len(terminated))
    return ReplayBatch(obs, torch.zeros(len(terminated), 2), ones, obs, torch.tensor(terminated), gamma * ones)


def test_target_by_hand(monkeypatch):
    """Reward 1, discount 0.8, critics 5 and 3, temperature 0.5, log-probability -2: 1 + 0.8 (3 + 1) = 4.2, or 1."""
    alg = make_runner(algorithm={"init_temperature": 0.5}).alg
    for target, value in zip(alg.targets, (5.0, 3.0), strict=True):
        target.mlp[-1].weight.data.zero_()
        target.mlp[-1].bias.data.fill_(value)
    monkeypatch.setattr(alg, "_sample", lambda obs: (torch.zeros(2, 2), torch.full((2,), -2.0)))
    torch.testing.assert_close(alg.targets_of(make_batch([0.0, 1.0])), torch.tensor([4.2, 1.0]))


def test_targets_follow_by_a_fraction():
    alg = make_runner(algorithm={"target_step": 0.25}).alg
    before = [parameter.clone() for parameter in alg.targets.parameters()]
    for parameter in alg.critics.parameters():
        parameter.data += 4.0
    alg._follow()
    for old, new in zip(before, alg.targets.parameters(), strict=True):
        torch.testing.assert_close(new, old + 1.0)


@pytest.mark.parametrize("target_entropy, rises", [(100.0, True), (-100.0, False)])
def test_temperature_rises_when_entropy_is_short(target_entropy, rises):
    alg = make_runner(algorithm={"target_entropy": target_entropy}).alg
    alg.step_on(make_batch([0.0, 0.0]))
    assert (float(alg.temperature.detach()) > 0.1) is rises


def test_fixed_temperature_stays():
    alg = make_runner(algorithm={"learn_temperature": False, "init_temperature": 0.5}).alg
    alg.step_on(make_batch([0.0, 0.0]))
    assert float(alg.temperature) == pytest.approx(0.5)


def test_actor_step_leaves_the_critics_alone():
    alg = make_runner(algorithm={"actor_interval": 1}).alg
    before = {name: value.clone() for name, value in alg.critics.state_dict().items()}
    alg._step_actor(make_batch([0.0, 0.0]).observations)
    assert all(torch.equal(value, before[name]) for name, value in alg.critics.state_dict().items())
    assert all(parameter.requires_grad for parameter in alg.critics.parameters())


@one_thread()
def test_steps_follow_the_transitions():
    """8 worlds x 8 steps x 0.25 = 16 gradient steps an iteration, once 256 transitions are there (iteration 4)."""
    runner = make_runner()
    runner.learn(3)
    assert runner.alg.num_updates == 0
    runner.learn(3)
    assert runner.alg.num_updates == 3 * 16
    assert runner.env.cfg.compute_final_obs


@one_thread()
def test_resumed_run_makes_the_same_step(tmp_path):
    runner = make_runner(log_dir=str(tmp_path), save_replay=True)
    runner.learn(6)
    resumed = make_runner(seed=9, save_replay=True)
    resumed.load(str(tmp_path / "model_5.pt"))
    runner.alg.replay.cut()
    assert resumed.alg.replay.num_transitions == 6 * 64
    for each in (runner, resumed):
        torch.manual_seed(3)
        each.alg.step_on(each.alg.replay.sample(32))
    for name, value in runner.alg.save().items():
        assert str(value) == str(resumed.alg.save()[name]), name
    for old, new in zip(runner.alg.critics.parameters(), resumed.alg.critics.parameters(), strict=True):
        assert torch.equal(old, new)


def test_policy_alone_is_loaded_for_play(tmp_path):
    runner, other = make_runner(), make_runner(seed=9)
    runner.save(str(tmp_path / "model_0.pt"))
    other.load(str(tmp_path / "model_0.pt"), load_cfg={"actor": True})
    obs = runner.env.get_observations()
    torch.testing.assert_close(other.get_inference_policy()(obs), runner.get_inference_policy()(obs))


def test_export_equals_the_policy(tmp_path):
    policy = make_runner().get_inference_policy()
    obs = SteerToDot(5).get_observations()
    expected = policy(obs).detach()
    jit = torch.jit.load(export_policy_as_jit(policy, tmp_path))
    torch.testing.assert_close(jit(torch.zeros(5, 0), [obs["policy"]]), expected)
    reference = pytest.importorskip("onnx.reference")
    session = reference.ReferenceEvaluator(str(export_policy_as_onnx(policy, tmp_path)))
    actions = session.run(None, {"policy": obs["policy"].numpy()})[0]
    torch.testing.assert_close(torch.from_numpy(actions), expected, rtol=1e-4, atol=1e-5)


def test_image_critics_step():
    critic = CnnQModelCfg(hidden_dims=[16], cnn_cfg=ENCODER, shift=1)
    runner = make_runner(critic=critic, obs_groups={"actor": ["policy"], "critic": ["policy"]})
    losses = runner.alg.step_on(make_batch([0.0, 1.0]))
    assert math.isfinite(float(losses["critic"]))


@one_thread()
def test_solves_the_dot():
    runner = make_runner(num_envs=32)
    runner.learn(32)
    assert mean_reward(SteerToDot(64), runner.get_inference_policy(), 80) > 0.75


def test_final_observation_is_what_the_value_of_a_time_out_sees():
    """In the last of 8 steps the next critic state of the sample is the final offset, not the new episode's."""
    runner = make_runner(num_envs=4)
    env, alg = runner.env, runner.alg
    obs, finals = env.get_observations(), None
    with torch.inference_mode():
        for step in range(10):
            obs, rewards, dones, extras = env.step(alg.act(obs))
            alg.process_env_step(obs, rewards, dones, extras)
            if step == 7:
                finals, last_rewards = extras["final_obs"]["critic"].clone(), rewards.clone()
    batch = alg.replay.sample(500)
    for world in range(4):
        hit = batch.rewards == last_rewards[world]
        assert bool(hit.any())
        assert torch.equal(batch.next_observations["critic"][hit][0], finals[world])
        assert float(batch.terminated[hit].max()) == 0.0


def test_unread_groups_are_not_stored():
    runner = make_runner()
    obs = runner.env.get_observations()
    wide = TensorDict({**dict(obs.items()), "extra": torch.zeros(8, 3)}, batch_size=[8])
    runner.env.get_observations = lambda: wide
    alg = type(runner.alg).construct_algorithm(wide, runner.env, runner.cfg, "cpu")
    assert set(alg.replay._layout) == {"policy", "critic"}


def test_mixed_precision_keeps_losses_in_full_precision():
    """The same batch gives nearly the same loss; what comes out of the networks is float32 again."""
    batch, losses = make_batch([0.0, 1.0]), []
    for mixed in (False, True):
        alg = make_runner(algorithm={"use_mixed_precision": mixed}).alg
        torch.manual_seed(1)
        losses.append(alg.critic_loss(batch))
        assert alg._sample(batch.observations)[0].dtype == losses[-1].dtype == torch.float32
    assert losses[0] != losses[1]
    torch.testing.assert_close(losses[1], losses[0], rtol=0.02, atol=0.02)


def test_modes_with_cuda_graphs_are_refused():
    with pytest.raises(UsageError, match="'reduce-overhead', which uses CUDA graphs"):
        make_runner(torch_compile_mode="reduce-overhead")


@pytest.mark.slow
def test_compiled_networks_make_the_same_step():
    batch = make_batch([0.0, 1.0])
    algs = [make_runner(torch_compile_mode=mode).alg for mode in (None, "default")]
    for alg in algs:
        alg.actor.shift = 0
        torch.manual_seed(1)
        alg.step_on(batch)
    for eager, compiled in zip(algs[0].critics.parameters(), algs[1].critics.parameters(), strict=True):
        torch.testing.assert_close(compiled, eager, rtol=1e-4, atol=1e-5)


@one_thread()
def test_several_steps_solve_the_dot_too():
    runner = make_runner(algorithm={"num_steps": 3})
    runner.learn(50)
    assert mean_reward(SteerToDot(64, seed=1), runner.get_inference_policy(), 80) > 0.6


def test_models_that_share_images_agree_on_their_size():
    actor = AugmentedCnnModelCfg(cnn_cfg=ENCODER, shrink=2, distribution_cfg=SquashedGaussianDistributionCfg())
    critic = CnnQModelCfg(cnn_cfg=ENCODER)
    groups = {"actor": ["policy"], "critic": ["policy"]}
    with pytest.raises(UsageError, match="shrink is 2 and agent.critic.shrink 1"):
        make_runner(actor=actor, critic=critic, obs_groups=groups)


def test_a_policy_cannot_wait_for_its_critics():
    with pytest.raises(UsageError, match="critic_first is 3 for SAC, expected 0"):
        make_runner(critic_first=3)
