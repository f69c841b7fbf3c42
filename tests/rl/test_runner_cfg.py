# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest

from arcgym.rl import BetaDistributionCfg, OnPolicyRunner, RslRlOnPolicyRunnerCfg, RslRlVecEnvWrapper
from arcgym.utils.configclass import configclass


def test_nones_are_left_out(agent_cfg):
    result = agent_cfg.to_dict()
    assert "distribution_cfg" not in result["critic"]
    assert "cnn_cfg" not in result["critic"]
    assert "torch_compile_mode" not in result
    assert result["actor"]["distribution_cfg"] == {
        "class_name": "GaussianDistribution",
        "init_std": 0.5,
        "std_type": "scalar",
        "learn_std": True,
    }


def test_wandb_becomes_a_writer():
    logger = RslRlOnPolicyRunnerCfg(logger="wandb", log_project_name="colon").to_dict()["logger"]
    assert logger == {"class_name": "WandbLogWriter", "project_name": "colon"}


def test_unknown_logger_lists_the_known():
    with pytest.raises(ValueError, match="'papyrus'.*tensorboard, wandb, neptune"):
        RslRlOnPolicyRunnerCfg(logger="papyrus").to_dict()


def test_subclass_keeps_the_conversion():
    @configclass
    class ColonRunnerCfg(RslRlOnPolicyRunnerCfg):
        experiment_name = "colon"

    result = ColonRunnerCfg().to_dict()
    assert result["experiment_name"] == "colon"
    assert "clip_actions" not in result


def test_instances_do_not_share_defaults():
    first, second = RslRlOnPolicyRunnerCfg(), RslRlOnPolicyRunnerCfg()
    first.actor.hidden_dims.append(1)
    assert second.actor.hidden_dims == [256, 128]


def test_beta_distribution_builds(counting_env, agent_cfg):
    agent_cfg.actor.distribution_cfg = BetaDistributionCfg()
    runner = OnPolicyRunner(RslRlVecEnvWrapper(counting_env), agent_cfg.to_dict(), device="cpu")
    assert runner.alg.actor.distribution.action_range == [-1.0, 1.0]
