# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Policies from checkpoints, to be evaluated."""

from __future__ import annotations

import hashlib
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


def file_sha256(path: Path) -> str:
    """Return the SHA-256 of a file, by which results name a checkpoint."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()
