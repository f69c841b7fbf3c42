# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Times acting and updates of an agent on noise."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass
from typing import Any

import torch
from rsl_rl.utils import resolve_callable

from arcgym.benchmarks.learner.noise_env import NoiseEnv

GRADIENT_STEPS = 32
"""Gradient steps of an off-policy agent's timed update."""

VARIANTS = {
    "plain": (False, None),
    "amp": (True, None),
    "compile": (False, "default"),
    "amp+compile": (True, "default"),
}
"""Mixed precision, and mode of ``torch.compile``."""


@dataclass(frozen=True)
class Shapes:
    """What a task shows to an agent."""

    num_envs: int = 512
    """Worlds."""

    size: int = 84
    """Edge of the images [px]."""

    frames: int = 5
    """Images in a stack."""

    num_states: int = 64
    """Width of the privileged state."""

    num_actions: int = 6
    """Width of the action."""


def prepare(agent_cfg: Any, variant: str, num_envs: int) -> Any:
    """Return an agent's configuration as a variant runs it; off-policy agents make :data:`GRADIENT_STEPS` an update."""
    uses_amp, mode = VARIANTS[variant]
    agent_cfg.algorithm.use_mixed_precision = uses_amp
    agent_cfg.torch_compile_mode = mode
    if hasattr(agent_cfg.algorithm, "updates_per_transition"):
        agent_cfg.algorithm.learning_starts = 1
        agent_cfg.algorithm.updates_per_transition = GRADIENT_STEPS / (agent_cfg.num_steps_per_env * num_envs)
    return agent_cfg


def time_updates(agent_cfg: Any, shapes: Shapes, device: str, repeats: int) -> dict[str, Any]:
    """Return the median times of an agent's rollout and update.

    Args:
        agent_cfg: The agent, see :func:`prepare`.
        shapes: What it sees.
        device: Where it learns.
        repeats: Timed updates, after two that are not.

    Returns:
        ``act_ms`` of the networks' part of a rollout, ``update_ms``, ``gradient_steps`` of an update,
        ``first_update_s`` with compiling, and ``device_mib``, the most memory that torch had in use.
    """
    torch.manual_seed(0)
    costs = list(getattr(agent_cfg.algorithm, "limits", {}))
    env = NoiseEnv(shapes.num_envs, shapes.size, shapes.frames, shapes.num_states, shapes.num_actions, costs, device)
    if device != "cpu":
        torch.cuda.reset_peak_memory_stats(device)
    runner = resolve_callable(agent_cfg.class_name)(env, agent_cfg.to_dict(), log_dir=None, device=device)
    runner.alg.train_mode()
    acts, updates = [], []
    for _ in range(repeats + 2):
        obs, start = env.get_observations(), _now(device)
        with torch.inference_mode():
            for _ in range(agent_cfg.num_steps_per_env):
                actions = runner.alg.act(obs)
                obs, rewards, dones, extras = env.step(actions)
                runner.alg.process_env_step(obs, rewards, dones, extras)
            runner.alg.compute_returns(obs)
        middle = _now(device)
        runner.alg.update()
        acts.append(1000.0 * (middle - start))
        updates.append(1000.0 * (_now(device) - middle))
    return {
        "act_ms": round(statistics.median(acts[2:]), 2),
        "update_ms": round(statistics.median(updates[2:]), 2),
        "gradient_steps": _gradient_steps(agent_cfg),
        "first_update_s": round(updates[0] / 1000.0, 1),
        "device_mib": round(torch.cuda.max_memory_allocated(device) / 2**20) if device != "cpu" else None,
    }


def _gradient_steps(agent_cfg: Any) -> int:
    algorithm = agent_cfg.algorithm
    if hasattr(algorithm, "updates_per_transition"):
        return GRADIENT_STEPS
    return algorithm.num_learning_epochs * algorithm.num_mini_batches


def _now(device: str) -> float:
    """Return the time when the device has done all its work [s]."""
    if device != "cpu":
        torch.cuda.synchronize(device)
    return time.perf_counter()
