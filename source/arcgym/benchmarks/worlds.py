# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Environments as the benchmarks build and step them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from arcgym.utils.errors import UsageError
from arcgym.utils.hydra import apply_overrides

OUT_OF_TIME = "no computing time left"
"""Problem of a patient in which an expert was stopped from outside."""


def load_env_cfg(
    task: str, overrides: Sequence[str], seed: int, num_envs: int | None = None, device: str | None = None
) -> Any:
    """Return a task's configuration with overrides; loads neither torch nor Newton.

    Args:
        task: Registered name.
        overrides: Texts ``env.path=value``.
        seed: Seed of the environment.
        num_envs: Worlds (default: the task's).
        device: Device of the simulation (default: the task's).

    Raises:
        UsageError: If there is no such task or field, or a value does not fit its field.
    """
    from arcgym.utils.registry import load_cfg_from_registry  # brings Gymnasium and numpy, which --help can do without

    try:
        cfg = load_cfg_from_registry(task, "env_cfg_entry_point")
        apply_overrides({"env": cfg}, overrides)
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error
    cfg.seed = seed
    if num_envs is not None:
        cfg.scene.num_envs = num_envs
    if device is not None:
        cfg.sim.device = "cuda:0" if device == "cuda" else device
    return cfg


def make_env(task: str, cfg: Any) -> Any:
    """Return the environment of a configuration after its first reset.

    Episodes begin at random ages: resets then come evenly, as in training, and not in all worlds at once.
    """
    import gymnasium as gym
    import torch

    torch.manual_seed(cfg.seed)
    env: Any = gym.make(task, cfg=cfg).unwrapped
    env.reset()
    env.episode_length_buf = torch.randint_like(env.episode_length_buf, env.max_episode_length)
    return env


def random_actions(env: Any) -> Any:
    """Return uniform raw actions between -1 and 1, shape (N, A)."""
    import torch

    return 2.0 * torch.rand(env.num_envs, env.action_manager.total_action_dim, device=env.device) - 1.0


def forward_axis(env: Any) -> int:
    """Return the raw action of a navigation task that drives the tip, or a pushed scope's base, forwards."""
    manager = env.action_manager
    names = [name for term in manager.active_terms for name in manager.get_term(term).axis_names]
    return next(axis for axis, name in enumerate(names) if name in ("insertion", "forward"))


def advance(env: Any, actions: Any) -> None:
    """Make the physics of a control step alone, without rewards and resets.

    Args:
        env: A manager-based environment.
        actions: Raw actions, shape (N, A).
    """
    env.action_manager.process_action(actions)
    env.action_manager.apply_action()
    env.sim.step(env.cfg.decimation)
