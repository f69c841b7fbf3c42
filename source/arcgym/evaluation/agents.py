# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Policies from checkpoints, to be evaluated."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from arcgym.evaluation.batched_policy import BatchedPolicy
from arcgym.rl.constrained_runner import ConstrainedPolicy
from arcgym.rl.rollout import Policy
from arcgym.rl.trained_policy import trained_policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper


def trained_agent(env: RslRlVecEnvWrapper, agent_cfg: Any, checkpoint: Path) -> Policy:
    """Return the policy of a checkpoint, whose answer for a world does not depend on the number of worlds."""
    policy = trained_policy(env, agent_cfg, checkpoint)
    if isinstance(policy, ConstrainedPolicy):
        return ConstrainedPolicy(BatchedPolicy(policy.policy, env.num_envs), policy.constraint)
    return BatchedPolicy(policy, env.num_envs)


def inputs_of(agent_cfg: Any) -> dict[str, Any]:
    """Return the observation groups that a trained agent acts by, and whether rules on its actions read true depth."""
    groups = getattr(agent_cfg, "obs_groups", None) or {}
    rules = getattr(agent_cfg, "action_constraint", None)
    simulated = rules is not None and rules.in_evaluation and _reads_truth(rules.depth)
    return {"sees": list(groups.get("actor", groups.get("student", ()))), "simulator_depth": simulated}


def _reads_truth(depth: Any) -> bool:
    return depth.weights is None or depth.align_to_simulator
