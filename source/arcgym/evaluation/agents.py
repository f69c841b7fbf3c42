# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Agents that can be evaluated: policies from checkpoints, and references that need none."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch
from rsl_rl.utils import resolve_callable

from arcgym.evaluation.batched_policy import BatchedPolicy
from arcgym.rl.expert_policy import ExpertPolicy
from arcgym.rl.rollout import Policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper


def zero_agent(env: RslRlVecEnvWrapper) -> Policy:
    """Return the agent whose raw actions are zero."""
    return lambda obs: torch.zeros(env.num_envs, env.num_actions, device=env.device)


def random_agent(env: RslRlVecEnvWrapper) -> Policy:
    """Return the agent whose raw actions are uniform in [-1, 1], drawn from the trial's random numbers."""
    return lambda obs: 2.0 * env.unwrapped.random.uniform("random agent", env.num_actions) - 1.0


REFERENCES: dict[str, Callable[[RslRlVecEnvWrapper], Policy]] = {
    "zero": zero_agent,
    "random": random_agent,
    "expert": ExpertPolicy,
}
"""Agents that need no checkpoint, by name; the expert sees what no camera sees."""


def trained_agent(env: RslRlVecEnvWrapper, agent_cfg: Any, checkpoint: Path) -> Policy:
    """Return the policy of a checkpoint, its mean actions."""
    runner = resolve_callable(agent_cfg.class_name)(env, agent_cfg.to_dict(), log_dir=None, device=env.device)
    runner.load(str(checkpoint), load_cfg={"actor": True})
    return BatchedPolicy(runner.get_inference_policy(env.device), env.num_envs)


def file_sha256(path: Path) -> str:
    """Return the SHA-256 of a file, by which results name a checkpoint."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()
