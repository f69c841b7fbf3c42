# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a new run takes over from another run's checkpoint, and what learns first."""

from __future__ import annotations

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import runner_cfg, with_memory

from arcgym.rl import GaussianDistributionCfg, OnPolicyRunner, RslRlMlpModelCfg
from arcgym.rl.pretrained import write_small
from arcgym.rl.run_folder import write_params
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread


def make_runner(seed: int, **changes) -> OnPolicyRunner:
    torch.manual_seed(seed)
    return OnPolicyRunner(SteerToDot(4), runner_cfg(**changes).to_dict(), device="cpu")


def same(first: dict[str, torch.Tensor], second: torch.nn.Module) -> bool:
    return all(torch.equal(value, first[name]) for name, value in second.state_dict().items())


def copied(model: torch.nn.Module) -> dict[str, torch.Tensor]:
    return {name: value.clone() for name, value in model.state_dict().items()}


@one_thread()
def test_the_critic_learns_first(tmp_path):
    first = make_runner(seed=0)
    first.save(str(tmp_path / "model_0.pt"))
    runner = make_runner(seed=1, init_policy=str(tmp_path / "model_0.pt"), critic_first=2)
    critic = copied(runner.alg.critic)
    runner.learn(2)
    assert same(copied(first.alg.actor), runner.alg.actor)
    assert not same(critic, runner.alg.critic)
    runner.learn(1)
    assert not same(copied(first.alg.actor), runner.alg.actor)


@one_thread()
def test_a_policy_of_other_activations_is_refused(tmp_path) -> None:
    """Its weights would fit, and act otherwise."""
    cfg = runner_cfg()
    cfg.actor.activation = "relu"
    write_params(tmp_path, run={"task": "Dot"}, env={}, agent=cfg)
    make_runner(seed=0, actor=cfg.actor).save(str(tmp_path / "model_0.pt"))
    with pytest.raises(UsageError, match="does not fit the policy: its activation is relu, and here it is elu"):
        make_runner(seed=1, init_policy=str(tmp_path / "model_0.pt")).learn(1)
    make_runner(seed=1, actor=cfg.actor, init_policy=str(tmp_path / "model_0.pt")).learn(1)


@one_thread()
def test_a_distilled_student_is_a_policy(tmp_path):
    first = make_runner(seed=0)
    first.save(str(tmp_path / "model_0.pt"))
    contents = torch.load(tmp_path / "model_0.pt", weights_only=True)
    contents["student_state_dict"] = contents.pop("actor_state_dict")
    torch.save(contents, tmp_path / "student.pt")
    runner = make_runner(seed=1, init_policy=str(tmp_path / "student.pt"), critic_first=1)
    runner.learn(1)
    assert same(copied(first.alg.actor), runner.alg.actor)


@one_thread()
def test_a_deviation_that_is_fixed_stays_so(tmp_path):
    distribution = GaussianDistributionCfg(init_std=0.3, learn_std=False)
    actor = runner_cfg().actor.replace(distribution_cfg=distribution)
    make_runner(seed=0, actor=actor).save(str(tmp_path / "model_0.pt"))
    runner = make_runner(seed=1, actor=actor, init_policy=str(tmp_path / "model_0.pt"), critic_first=1)
    runner.learn(2)
    assert float(runner.alg.actor.output_std.mean()) == pytest.approx(0.3)


@one_thread()
def test_without_another_runs_policy_all_learn_at_once(capsys):
    runner = make_runner(seed=1, critic_first=2)
    actor = copied(runner.alg.actor)
    runner.learn(1)
    assert not same(actor, runner.alg.actor)
    assert "note: agent.critic_first=2 waits for nothing" in capsys.readouterr().out


def test_a_checkpoint_of_another_policy_is_named(tmp_path):
    make_runner(
        seed=0,
        actor=RslRlMlpModelCfg(hidden_dims=[8], distribution_cfg=GaussianDistributionCfg()),
        obs_groups={"actor": ["critic"], "critic": ["critic"]},
    ).save(str(tmp_path / "other.pt"))
    runner = make_runner(seed=1, init_policy=str(tmp_path / "other.pt"))
    with pytest.raises(UsageError, match="init_policy=.*other.pt does not fit the policy"):
        runner.learn(0)


@one_thread()
@pytest.mark.parametrize("rnn_type", ["lstm", "gru"])
def test_a_policy_without_memory_is_the_start_of_one_with_it(tmp_path, rnn_type):
    """Columns of zeros read the memory: whatever it holds after a step, nothing is added to the actions."""
    first = make_runner(seed=0)
    first.save(str(tmp_path / "model_0.pt"))
    runner = make_runner(seed=1, actor=with_memory(rnn_type=rnn_type), init_policy=str(tmp_path / "model_0.pt"))
    recurrent = copied(runner.alg.actor.rnn)
    runner.learn(0)
    actor, env = runner.alg.actor, SteerToDot(4)
    assert same(recurrent, actor.rnn)
    assert not actor.mlp[0].weight[:, -4:].any()
    actor.reset()
    with torch.no_grad():
        for _ in range(5):
            obs = env.get_observations()
            actions = actor(obs)
            assert torch.equal(actions, first.alg.actor(obs))
            assert actor.get_latent(obs)[:, -4:].any()
            env.step(actions)


@one_thread()
def test_a_policy_with_a_memory_learns_on_with_it_and_starts_others(tmp_path):
    make_runner(seed=0).save(str(tmp_path / "model_0.pt"))
    runner = make_runner(seed=1, actor=with_memory(), init_policy=str(tmp_path / "model_0.pt"), critic_first=1)
    runner.learn(2)
    runner.save(str(tmp_path / "model_1.pt"))
    assert runner.alg.actor.mlp[0].weight[:, -4:].any()
    further = make_runner(seed=2, actor=with_memory(), init_policy=str(tmp_path / "model_1.pt"))
    further.learn(0)
    assert same(copied(runner.alg.actor), further.alg.actor)


@one_thread()
@pytest.mark.parametrize("normalized", [True, False])
def test_a_policy_of_images_is_the_start_of_one_that_reads_vectors_besides(tmp_path, normalized: bool) -> None:
    """Columns of zeros read the vectors, so that it acts as before; an update gives them weights."""
    first = make_runner(seed=0)
    first.save(str(tmp_path / "model_0.pt"))
    runner = make_runner(
        seed=1,
        actor=runner_cfg().actor.replace(obs_normalization=normalized),
        obs_groups={"actor": ["policy", "critic"], "critic": ["critic"]},
        init_policy=str(tmp_path / "model_0.pt"),
    )
    runner.learn(0)
    obs, actor = SteerToDot(4).get_observations(), runner.alg.actor
    assert torch.equal(actor(obs), first.alg.actor(obs))
    assert not actor.mlp[0].weight[:, : actor.obs_dim].any()
    runner.learn(1)
    assert actor.obs_dim > 0 and actor.mlp[0].weight[:, : actor.obs_dim].any()


def test_small_weights_hold_a_memory(tmp_path):
    """A GRU of 64 numbers has 64 x 3 x 64 weights that are worth it: whole numbers, off by 1/254 of a row's largest."""
    cfg = with_memory(rnn_hidden_dim=64)
    first, other = make_runner(seed=0, actor=cfg), make_runner(seed=1, actor=cfg)
    first.save(str(tmp_path / "model_0.pt"))
    write_small(tmp_path / "model_0.pt", tmp_path / "small.pt")
    other.load(str(tmp_path / "small.pt"), load_cfg={"actor": True})
    wanted, got = first.alg.actor.rnn.rnn.weight_hh_l0, other.alg.actor.rnn.rnn.weight_hh_l0
    assert bool(((got - wanted).abs() <= wanted.abs().amax(1, keepdim=True) / 253).all())


@pytest.mark.parametrize(
    "changes", [{"skip_connection": False}, {"hidden_dims": [16]}, {"shrink": 2}], ids=["no skip", "width", "images"]
)
def test_a_memory_does_not_make_another_policy_fit(tmp_path, changes):
    make_runner(seed=0).save(str(tmp_path / "model_0.pt"))
    runner = make_runner(seed=1, actor=with_memory(**changes), init_policy=str(tmp_path / "model_0.pt"))
    with pytest.raises(UsageError, match="init_policy=.*model_0.pt does not fit the policy") as refused:
        runner.learn(0)
    assert "size mismatch for mlp.0.weight" in str(refused.value) and "\n" not in str(refused.value)


def test_a_memory_of_another_width_is_refused(tmp_path):
    make_runner(seed=0, actor=with_memory(rnn_hidden_dim=3)).save(str(tmp_path / "model_0.pt"))
    runner = make_runner(seed=1, actor=with_memory(), init_policy=str(tmp_path / "model_0.pt"))
    with pytest.raises(UsageError, match="does not fit the policy"):
        runner.learn(0)


def test_a_policy_with_memory_is_no_start_of_one_without(tmp_path):
    make_runner(seed=0, actor=with_memory()).save(str(tmp_path / "model_0.pt"))
    runner = make_runner(seed=1, init_policy=str(tmp_path / "model_0.pt"))
    with pytest.raises(UsageError, match="does not fit the policy"):
        runner.learn(0)
