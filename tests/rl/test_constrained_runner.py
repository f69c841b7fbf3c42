# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

from types import SimpleNamespace

import pytest
import torch
from pixel_tasks import SteerToDot
from small_agents import runner_cfg

from arcgym.rl import constrained_runner, export_policy_as_jit
from arcgym.rl.agent_cfgs.ppo_masked import ActionConstraintCfg, RslRlConstrainedRunnerCfg
from arcgym.rl.constrained_runner import ConstrainedRunner
from arcgym.rl.trained_policy import trained_policy


@pytest.fixture
def env(monkeypatch) -> SteerToDot:
    """Two action axes, pitch and yaw, and a lumen to the left and above: both must not be what they ask against."""
    env = SteerToDot(4)
    depth = torch.full((4, 5, 5), 0.02)
    depth[:, 0, 0] = 0.1
    env.scene = {"camera": SimpleNamespace(data=SimpleNamespace(output={"depth": depth}))}
    env.carried_out = []
    step = env.step
    env.step = lambda actions: (env.carried_out.append(actions.clone()), step(actions))[1]
    monkeypatch.setattr(constrained_runner, "action_axes", lambda env: ("pitch", "yaw"))
    return env


def make_cfg(**switches) -> RslRlConstrainedRunnerCfg:
    base = runner_cfg()
    constraint = ActionConstraintCfg(**switches)
    values = {name: getattr(base, name) for name in vars(base) if name != "class_name"}
    return RslRlConstrainedRunnerCfg(**values, action_constraint=constraint)


def make_runner(env, **switches) -> ConstrainedRunner:
    torch.manual_seed(0)
    return ConstrainedRunner(env, make_cfg(**switches).to_dict(), device="cpu")


def allowed(actions: torch.Tensor) -> torch.Tensor:
    return torch.stack((actions[..., 0].clamp(max=0.0), actions[..., 1].clamp(min=0.0)), dim=-1)


def test_environment_obeys_and_the_learner_keeps_its_own_actions(env):
    runner = make_runner(env)
    runner.learn(1)
    chosen = runner.alg.storage.actions
    assert not torch.equal(allowed(chosen), chosen)
    torch.testing.assert_close(torch.stack(env.carried_out), allowed(chosen))


def test_training_can_be_free_of_the_rules(env):
    runner = make_runner(env, in_training=False)
    runner.learn(1)
    torch.testing.assert_close(torch.stack(env.carried_out), runner.alg.storage.actions)


@pytest.mark.parametrize("in_evaluation", [True, False])
def test_evaluation_obeys_if_asked_to(env, in_evaluation):
    runner = make_runner(env, in_evaluation=in_evaluation)
    obs = env.get_observations()
    free = runner.alg.get_policy()(obs)
    expected = allowed(free) if in_evaluation else free
    assert not torch.equal(allowed(free), free)
    torch.testing.assert_close(runner.get_inference_policy("cpu")(obs), expected)


@pytest.mark.parametrize("in_evaluation", [True, False])
def test_a_loaded_policy_says_that_it_obeys_rules(env, tmp_path, capsys, in_evaluation):
    make_runner(env).save(str(tmp_path / "model_0.pt"))
    env.device = "cpu"
    trained_policy(env, make_cfg(in_evaluation=in_evaluation), tmp_path / "model_0.pt")
    assert ("agent.action_constraint.in_evaluation=false" in capsys.readouterr().out) == in_evaluation


def test_exported_policy_is_free_of_the_rules(env, tmp_path):
    runner = make_runner(env)
    obs = env.get_observations()
    exported = torch.jit.load(export_policy_as_jit(runner.get_inference_policy("cpu"), tmp_path))
    torch.testing.assert_close(exported(torch.zeros(4, 0), [obs["policy"]]), runner.alg.get_policy()(obs))


def test_checkpoint_counts_the_environments_steps(env, tmp_path):
    runner = make_runner(env)
    runner.learn(1)
    runner.save(str(tmp_path / "model_0.pt"))
    env.common_step_counter = 0
    make_runner(env).load(str(tmp_path / "model_0.pt"))
    assert env.common_step_counter == 8
