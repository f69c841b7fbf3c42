# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Policies from checkpoints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rsl_rl.utils import resolve_callable

from arcgym.rl.rollout import Policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper


def trained_policy(env: RslRlVecEnvWrapper, agent_cfg: Any, checkpoint: Path) -> Policy:
    """Return the policy of a checkpoint, its mean actions, on the environment's device.

    Says so when its actions obey rules, because results belong beside those without.

    Args:
        env: Environment of the task.
        agent_cfg: Configuration that the agent was trained with.
        checkpoint: File that its runner has saved; read as weights only.
    """
    runner = resolve_callable(agent_cfg.class_name)(env, agent_cfg.to_dict(), log_dir=None, device=env.device)
    runner.load(str(checkpoint), load_cfg={"actor": True})
    policy = runner.get_inference_policy(env.device)
    if hasattr(policy, "constraint"):
        print("actions obey rules; report beside this: agent.action_constraint.in_evaluation=false")
    return policy
