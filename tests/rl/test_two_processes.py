# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Two processes that share a batch make the step that one makes on all of it."""

from __future__ import annotations

from typing import Any

import pytest
import torch
import torch.multiprocessing
from small_agents import runner_cfg
from test_sac import SteerToDot
from test_sac import make_runner as make_sac_runner

from arcgym.rl import OnPolicyRunner, RslRlMlpModelCfg, RslRlOnPolicyRunnerCfg
from arcgym.rl.agent_cfgs.a2c import RslRlA2cAlgorithmCfg
from arcgym.rl.agent_cfgs.ppo_predicting import RslRlPpoPredictingAlgorithmCfg
from arcgym.rl.episode_costs import EpisodeCosts
from arcgym.rl.replay import ReplayBatch

NUM_ENVS, STEPS = 8, 8


def a2c_step(worlds: slice, processes: int) -> list[torch.Tensor]:
    """Weights after a step of A2C on some worlds of a rollout."""
    algorithm = RslRlA2cAlgorithmCfg(optimizer="sgd", learning_rate=0.1)
    alg = on_policy_step(runner_cfg(algorithm=algorithm), worlds, processes)
    return [p.detach() for model in (alg.actor, alg.critic) for p in model.parameters()]


def predicting_step(worlds: slice, processes: int) -> list[torch.Tensor]:
    """Weights after a step of PPO with its predicting head."""
    steps = {"schedule": "fixed", "num_learning_epochs": 1, "num_mini_batches": 1, "max_grad_norm": 1.0e9}
    algorithm = RslRlPpoPredictingAlgorithmCfg(optimizer="sgd", learning_rate=0.1, **steps)
    cfg = runner_cfg(algorithm=algorithm, critic=RslRlMlpModelCfg(hidden_dims=[32], obs_normalization=True))
    alg = on_policy_step(cfg, worlds, processes)
    return [p.detach() for model in (alg.actor, alg.critic, alg.head) for p in model.parameters()]


def on_policy_step(cfg: RslRlOnPolicyRunnerCfg, worlds: slice, processes: int) -> Any:
    """Return the algorithm after a step on some worlds of a rollout; processes draw first weights of their own."""
    torch.manual_seed(worlds.start)
    alg: Any = OnPolicyRunner(SteerToDot(worlds.stop - worlds.start), cfg.to_dict(), device="cpu").alg
    alg.is_multi_gpu, alg.gpu_world_size = processes > 1, processes
    if processes > 1:
        alg.broadcast_parameters()
    torch.manual_seed(1)
    st = alg.storage
    images = torch.randint(0, 256, (STEPS, NUM_ENVS, 1, 16, 16), dtype=torch.uint8)
    actions, values, returns = torch.randn(STEPS, NUM_ENVS, 2), *torch.randn(2, STEPS, NUM_ENVS, 1)
    st.observations["policy"][:] = images[:, worlds]
    st.observations["critic"][:] = images[:, worlds, 0, 0, :2].float() / 255.0
    with torch.no_grad():
        alg.actor(st.observations.flatten(0, 1), stochastic_output=True)
        log_prob = alg.actor.get_output_log_prob(actions[:, worlds].flatten(0, 1))
        st.distribution_params = tuple(p.view(STEPS, -1, 2) for p in alg.actor.output_distribution_params)
    st.actions[:], st.values[:], st.returns[:] = actions[:, worlds], values[:, worlds], returns[:, worlds]
    st.actions_log_prob[:] = log_prob.view(STEPS, -1, 1)
    st.advantages[:] = st.returns - st.values
    alg.update()
    return alg


def sac_step(worlds: slice, processes: int) -> list[torch.Tensor]:
    """Weights after a step on some of the transitions, without the noise of the actions and of the images."""
    alg = make_sac_runner().alg
    alg.is_multi_gpu, alg.gpu_world_size = processes > 1, processes
    alg.actor.shift = 0
    alg._sample = lambda obs: ((actions := alg.actor(obs)), actions.sum(dim=1))
    obs = SteerToDot(NUM_ENVS).get_observations()[worlds]
    rewards, terminated = torch.arange(float(NUM_ENVS))[worlds], torch.zeros(NUM_ENVS)[worlds]
    discounts = torch.full_like(rewards, 0.8)
    alg.step_on(ReplayBatch(obs, torch.zeros(len(rewards), 2), rewards, obs, terminated, discounts))
    return [p.detach() for model in (alg.actor, alg.critics) for p in model.parameters()]


def episode_costs(worlds: slice, processes: int) -> list[torch.Tensor]:
    """Mean cost, which moves the multipliers, of episodes that cost as much as their world's number says."""
    costs = torch.arange(float(NUM_ENVS))[worlds].unsqueeze(0)
    tracker = EpisodeCosts(1, costs.shape[1], "cpu")
    for _ in range(2):  # the first episode of a world does not count
        tracker.add(costs, torch.ones(costs.shape[1]))
    return [torch.tensor(tracker.take_means())]


STEP = {"a2c": a2c_step, "ppo predicting": predicting_step, "sac": sac_step, "episode costs": episode_costs}


def work(rank: int, name: str, folder: str) -> None:
    torch.distributed.init_process_group("gloo", init_method=f"file://{folder}/store", rank=rank, world_size=2)
    half = NUM_ENVS // 2
    torch.save(STEP[name](slice(rank * half, (rank + 1) * half), processes=2), f"{folder}/{rank}.pt")
    torch.distributed.destroy_process_group()


@pytest.mark.slow
@pytest.mark.parametrize("name", STEP)
def test_step_is_that_of_the_joined_batch(name, tmp_path):
    torch.multiprocessing.spawn(work, args=(name, str(tmp_path)), nprocs=2)
    joined = STEP[name](slice(0, NUM_ENVS), processes=1)
    for rank in range(2):
        for ours, whole in zip(torch.load(tmp_path / f"{rank}.pt"), joined, strict=True):
            torch.testing.assert_close(ours, whole, rtol=1e-4, atol=1e-6)
