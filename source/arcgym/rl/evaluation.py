# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What a policy achieves after training: each world's first episode in the environment that it was trained in."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from arcgym.rl.first_episodes import write_rows
from arcgym.rl.rollout import RolloutResult, run_policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper
from arcgym.utils.files import write_whole
from arcgym.utils.progress import counted

EPISODES_FILE = "episodes.csv"
"""A row an episode, see :meth:`arcgym.rl.first_episodes.FirstEpisodes.rows`."""

EVALUATION_FILE = "evaluation.json"
"""Means over the episodes, as ``arcgym play --json`` prints them."""

WITHOUT_RULES = "without_rules_"
"""Beginning of the files of a policy whose rules on actions were taken away."""

EVALUATION_SEED = 1000
"""Seed of the environment, the same for all policies: they meet the same starts, as far as their number of worlds is
the same."""


def evaluate(runner: Any, env: RslRlVecEnvWrapper, device: str, folder: Path | None) -> None:
    """Run the policy's mean actions until each world's first episode has ended, print the figures and write them.

    A policy whose actions obey rules is run a second time without them, which gives ``without_rules_episodes.csv`` and
    ``without_rules_evaluation.json``.

    Args:
        runner: Runner with the policy.
        env: Environment to run it in; its worlds start anew.
        device: Device of the policy.
        folder: Where the files go, or None for no files.
    """
    policy = runner.get_inference_policy(device)
    _evaluate(policy, env, folder, "")
    if hasattr(policy, "constraint"):
        _evaluate(policy.policy, env, folder, WITHOUT_RULES)


def _evaluate(policy: Any, env: RslRlVecEnvWrapper, folder: Path | None, prefix: str) -> None:
    """Run one policy and write its files."""
    env.reset(seed=EVALUATION_SEED)
    if hasattr(policy, "reset"):
        policy.reset()
    with counted(f"{prefix.replace('_', ' ')}evaluation", int(env.max_episode_length)) as show:
        result: RolloutResult = run_policy(env, policy, on_step=show)
    print(f"{prefix.replace('_', ' ')}evaluation: {result}", flush=True)
    if folder is not None:
        write_rows(folder / f"{prefix}{EPISODES_FILE}", result.first_episodes)
        write_whole(
            folder / f"{prefix}{EVALUATION_FILE}", (json.dumps(json.loads(result.to_json()), indent=1)).encode()
        )
