# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import os
import signal

import numpy as np
import pytest
import torch
from pixel_tasks import SteerToDot, mean_reward
from small_agents import actor_cfg, runner_cfg

from arcgym.managers import Episode, save_episode
from arcgym.rl import OnPolicyRunner
from arcgym.rl.agent_cfgs.imitation import RslRlBehaviorCloningAlgorithmCfg, RslRlBehaviorCloningRunnerCfg
from arcgym.rl.algorithms.behavior_cloning import deviations
from arcgym.rl.behavior_cloning_runner import BehaviorCloningRunner
from arcgym.rl.demonstrations import read_demonstrations
from arcgym.rl.expert_demonstrations import ask_expert
from arcgym.rl.interrupt import TrainingInterrupted
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread


def write_episode(folder, number: int, success: bool = True, **data: np.ndarray) -> None:
    episode = Episode(data, {"success": success, "length": len(data["actions"])})
    save_episode(episode, folder / f"episode_{number:06d}.hdf5")


def record_expert(folder, worlds: int = 64) -> None:
    """Record one episode of each world, steered straight to the dot."""
    env, images, actions = SteerToDot(worlds), [], []
    for _ in range(env.episode_steps):
        images.append(env.observe()["policy"].numpy())
        actions.append((-4.0 * env.offset).clamp(-1.0, 1.0))
        env.step(actions[-1])
    for world in range(worlds):
        steps = {"obs/policy": np.stack([image[world] for image in images])}
        write_episode(folder, world, actions=np.stack([action[world].numpy() for action in actions]), **steps)


def make_runner(folder, num_envs: int = 16, log_dir=None, **algorithm) -> BehaviorCloningRunner:
    torch.manual_seed(0)
    settings = {"demonstrations": str(folder), "learning_rate": 3e-3, "batch_size": 64, "steps_per_update": 20}
    cfg = RslRlBehaviorCloningRunnerCfg(
        actor=actor_cfg(), algorithm=RslRlBehaviorCloningAlgorithmCfg(**(settings | algorithm))
    )
    return BehaviorCloningRunner(SteerToDot(num_envs), cfg.to_dict(), log_dir=log_dir, device="cpu")


def test_failed_episodes_are_left_out(tmp_path):
    for number, success in enumerate((True, False)):
        steps = np.full((3, 1), number, dtype=np.float32)
        write_episode(tmp_path, number, success, actions=steps, **{"obs/policy": steps})
    assert read_demonstrations(tmp_path, ["policy"], "cpu").actions.flatten().tolist() == [0, 0, 0]
    assert len(read_demonstrations(tmp_path, ["policy"], "cpu", successful_only=False)) == 6


def test_missing_observations_name_the_cure(tmp_path):
    write_episode(tmp_path, 0, actions=np.zeros((3, 1)))
    with pytest.raises(UsageError, match="no 'obs/policy'.*holds: actions.*PreStepObservationsRecorderCfg"):
        read_demonstrations(tmp_path, ["policy"], "cpu")


def test_empty_folder_is_named(tmp_path):
    with pytest.raises(UsageError, match="No successful episodes"):
        read_demonstrations(tmp_path, ["policy"], "cpu")


def test_folder_must_be_given(tmp_path):
    with pytest.raises(UsageError, match="agent.algorithm.demonstrations"):
        make_runner("", log_dir=str(tmp_path))


def test_actions_must_be_the_tasks(tmp_path):
    write_episode(tmp_path, 0, actions=np.zeros((3, 5)), **{"obs/policy": np.zeros((3, 1, 16, 16), dtype=np.uint8)})
    with pytest.raises(UsageError, match="have 5 actions, expected 2"):
        make_runner(tmp_path, log_dir=str(tmp_path / "run"))


def test_loss_is_the_mean_square_to_the_clipped_action(tmp_path):
    """A policy that answers zero, recorded actions 3 and -0.5: (1 + 0.25) / 2."""
    record_expert(tmp_path, worlds=2)
    alg = make_runner(tmp_path).alg
    alg.actor.mlp[-1].weight.data.zero_()
    alg.actor.mlp[-1].bias.data.zero_()
    obs = SteerToDot(1).get_observations()
    assert float(alg.step_on(obs, torch.tensor([[3.0, -0.5]]))) == pytest.approx(0.625)


def test_loss_in_deviations_counts_a_small_action_as_much_as_a_large_one(tmp_path):
    """A policy that answers zero; recorded are (1, 0.1) and (-1, -0.1), deviations 1 and 0.1: each action's loss is 1.

    For (0.5, 0.2) it is (0.25 + 4) / 2. In raw actions the first would be (1 + 0.01) / 2.
    """
    shown = np.array([[1.0, 0.1], [-1.0, -0.1]], dtype=np.float32)
    write_episode(tmp_path, 0, actions=shown, **{"obs/policy": SteerToDot(2).observe()["policy"].numpy()})
    obs = SteerToDot(1).get_observations()
    for action, expected in (([1.0, 0.1], 1.0), ([0.5, 0.2], 2.125)):
        alg = make_runner(tmp_path, log_dir=str(tmp_path / "run"), action_units="deviation").alg
        alg.actor.mlp[-1].weight.data.zero_()
        alg.actor.mlp[-1].bias.data.zero_()
        assert float(alg.step_on(obs, torch.tensor([action]))) == pytest.approx(expected)


def test_an_action_that_is_never_used_has_the_least_unit():
    actions = torch.tensor([[0.0, 3.0], [0.0, -1.0]])
    torch.testing.assert_close(deviations(actions), torch.tensor([0.02, 1.0]))


@one_thread()
def test_an_expert_that_is_asked_on_corrects_where_the_policy_drives(tmp_path):
    record_expert(tmp_path, worlds=2)
    runner = make_runner(tmp_path)
    before, env = len(runner.alg.read_demonstrations()), runner.env
    forgotten: list[torch.Tensor] = []

    class Expert:
        reset = staticmethod(forgotten.append)

        def __call__(self, obs):
            return (-4.0 * env.offset).clamp(-1.0, 1.0)

    runner.alg.expert = Expert()
    runner.learn(3)
    kept = runner.alg.read_demonstrations()
    steps = 3 * runner.cfg["num_steps_per_env"]
    assert len(kept) == before + steps * env.num_envs and len(forgotten) == steps
    assert kept.observations.batch_size == (len(kept),) and kept.actions.abs().max() <= 1.0


def test_only_an_expert_can_be_asked_on():
    with pytest.raises(ValueError, match="asks_on is true with demonstrations 'folder', expected 'expert'"):
        RslRlBehaviorCloningAlgorithmCfg(asks_on=True, demonstrations="folder").validate_config()


def test_unknown_units_are_named():
    with pytest.raises(ValueError, match="action_units is .std.*deviation, raw"):
        RslRlBehaviorCloningAlgorithmCfg(action_units="std").validate_config()


@one_thread()
def test_solves_the_dot_and_starts_ppo(tmp_path):
    record_expert(tmp_path)
    runner = make_runner(tmp_path)
    runner.learn(15)
    policy = runner.get_inference_policy()
    assert mean_reward(SteerToDot(64, seed=1), policy, 80) > 0.75
    runner.save(str(tmp_path / "model_14.pt"))
    ppo = OnPolicyRunner(SteerToDot(16), runner_cfg().to_dict(), device="cpu")
    ppo.load(str(tmp_path / "model_14.pt"), load_cfg={"actor": True})
    obs = SteerToDot(16).get_observations()
    torch.testing.assert_close(ppo.get_inference_policy()(obs), policy(obs))


def test_playing_needs_no_demonstrations(tmp_path):
    record_expert(tmp_path, worlds=2)
    runner, player = make_runner(tmp_path), make_runner("moved away")
    runner.save(str(tmp_path / "model_0.pt"))
    player.load(str(tmp_path / "model_0.pt"), load_cfg={"actor": True})
    obs = SteerToDot(2).get_observations()
    torch.testing.assert_close(player.get_inference_policy()(obs), runner.get_inference_policy()(obs))


@one_thread()
def test_resumed_run_makes_the_same_step(tmp_path):
    record_expert(tmp_path, worlds=4)
    runner, resumed = make_runner(tmp_path), make_runner(tmp_path)
    runner.learn(2)
    runner.save(str(tmp_path / "model_1.pt"))
    resumed.load(str(tmp_path / "model_1.pt"))
    for each in (runner, resumed):
        torch.manual_seed(3)
        each.alg.update()
    for old, new in zip(runner.alg.actor.parameters(), resumed.alg.actor.parameters(), strict=True):
        assert torch.equal(old, new)


class Shown(SteerToDot):
    """Worlds that can start anew; those with an even number succeed."""

    def __init__(self, num_envs: int):
        super().__init__(num_envs)
        self.carried_out: list[torch.Tensor] = []
        self.succeeded = torch.arange(num_envs) % 2 == 0

    def reset(self):
        self.episode_length_buf.zero_()
        self.start(torch.ones(self.num_envs, dtype=torch.bool))
        return self.get_observations(), {}

    def step(self, actions):
        self.carried_out.append(actions)
        return super().step(actions)


def test_the_expert_is_asked_until_there_are_enough_steps():
    """Episodes of 8 steps in 4 worlds, of which 2 succeed: 16 steps a round, and two rounds for 20."""
    env = Shown(4)
    shown = ask_expert(env, lambda obs: torch.full((4, 2), 0.5), ["policy"], "cpu", 20)
    assert (len(shown), shown.num_episodes) == (32, 4)
    assert len(ask_expert(env, lambda obs: torch.zeros(4, 2), ["policy"], "cpu", 20, successful_only=False)) == 32
    assert shown.observations["policy"].dtype == torch.uint8


def test_noise_is_carried_out_and_not_kept():
    env = Shown(2)
    shown = ask_expert(env, lambda obs: torch.full((2, 2), 0.5), ["policy"], "cpu", 8, noise=0.3)
    assert torch.all(shown.actions == 0.5)
    assert 0.1 < (torch.cat(env.carried_out) - 0.5).std() < 0.5


def test_a_round_shows_how_far_it_is(capsys):
    """A round of 8 steps in 4 worlds: 32 steps, a line at least for every tenth of them."""
    ask_expert(Shown(4), lambda obs: torch.zeros(4, 2), ["policy"], "cpu", 32)
    shown = capsys.readouterr().out
    assert all(f"{done} of 32" in shown for done in (4, 16, 32)), shown


def test_an_expert_that_never_succeeds_is_named():
    env = Shown(2)
    env.succeeded[:] = False
    with pytest.raises(UsageError, match="none succeeded"):
        ask_expert(env, lambda obs: torch.zeros(2, 2), ["policy"], "cpu", 8)


def asked_runner(monkeypatch, **settings) -> BehaviorCloningRunner:
    """A runner that asks an expert for one round of 8 steps in 4 worlds."""
    torch.manual_seed(0)
    algorithm = RslRlBehaviorCloningAlgorithmCfg(demonstrations="expert", expert_steps=8, steps_per_update=1)
    cfg = RslRlBehaviorCloningRunnerCfg(actor=actor_cfg(), algorithm=algorithm, **settings)
    monkeypatch.setattr(
        "arcgym.rl.behavior_cloning_runner.ExpertPolicy", lambda env: lambda obs: (-4.0 * env.offset).clamp(-1.0, 1.0)
    )
    return BehaviorCloningRunner(Shown(4), cfg.to_dict(), log_dir=None, device="cpu")


def test_the_expert_gets_its_settings(monkeypatch):
    runner = asked_runner(monkeypatch)
    runner.alg.expert_settings = {"speed": -0.005}
    given = {}
    monkeypatch.setattr(
        "arcgym.rl.behavior_cloning_runner.ExpertPolicy",
        lambda env, **settings: given.update(settings) or (lambda obs: torch.zeros(4, 2)),
    )
    runner.learn(1)
    assert given == {"speed": -0.005}


def test_asking_counts_among_the_transitions(monkeypatch):
    """One round of 8 steps in 4 worlds, then one iteration of 4 steps: 48 transitions."""
    runner = asked_runner(monkeypatch)
    runner.learn(1)
    assert runner.clock.transitions == 48


def test_a_policy_that_was_left_no_time_to_learn_is_refused(monkeypatch):
    runner = asked_runner(monkeypatch, max_minutes=1e-6)
    with pytest.raises(UsageError, match="Asking the expert took .* nothing was learnt"):
        runner.learn(1)
    assert runner.env.common_step_counter == 1, "the round was not ended"


def test_a_kill_unwinds_while_the_expert_is_asked(monkeypatch):
    runner = asked_runner(monkeypatch)
    step = runner.env.step

    def killed(actions: torch.Tensor):
        os.kill(os.getpid(), signal.SIGTERM)
        return step(actions)

    monkeypatch.setattr(runner.env, "step", killed)
    with pytest.raises(TrainingInterrupted):
        runner.learn(1)
