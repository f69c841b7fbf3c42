# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Demonstrations that the robot's scripted expert gives in the environment itself, without files."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import torch
from rsl_rl.env import VecEnv
from tensordict import TensorDict

from arcgym.rl.demonstrations import Demonstrations
from arcgym.rl.rollout import Policy
from arcgym.utils.errors import UsageError
from arcgym.utils.progress import counted


def ask_expert(
    env: VecEnv,
    expert: Policy,
    groups: list[str],
    device: str,
    num_steps: int,
    noise: float = 0.0,
    successful_only: bool = True,
    check: Callable[[], None] = lambda: None,
) -> Demonstrations:
    """Let the expert act until there are enough steps of it, and return them.

    Each action that is carried out has noise on it, each that is kept has none: the expert shows how to get back from
    where a learner's mistakes lead (Laskey et al. 2017, arXiv:1703.09327). Worlds start anew before and after.

    Args:
        env: Environment of rsl_rl.
        expert: Policy to ask, such as :class:`arcgym.rl.expert_policy.ExpertPolicy`.
        groups: Observation groups to keep.
        device: Where the steps are kept.
        num_steps: Steps to keep, at least. Rounds of whole episodes are made until there are as many.
        noise: Standard deviation of the noise, in raw actions.
        successful_only: Whether episodes that the task's success did not end are left out.
        check: Called after every control step; it may raise, to end a round that takes too long.

    Raises:
        UsageError: A round of episodes in all worlds held nothing to keep.
    """
    kept: list[tuple[TensorDict, torch.Tensor]] = []
    episodes = count = 0
    with counted("asking the expert", num_steps) as show, torch.inference_mode():
        while count < num_steps:
            tell = partial(_tell, show, count, num_steps)
            found, number = _round(env, expert, groups, device, noise, successful_only, tell, check)
            if number == 0:
                wanted = "succeeded" if successful_only else "ended"
                raise UsageError(f"The expert's first episodes of {env.num_envs} worlds: none {wanted}.")
            kept += found
            episodes += number
            count += sum(len(actions) for _, actions in found)
            show(min(count, num_steps))
        env.reset()
    observations: Any = torch.cat([obs for obs, _ in kept])  # type: ignore[arg-type]
    return Demonstrations(observations, torch.cat([actions for _, actions in kept]), episodes)


def _tell(show: Callable[[int], None], before: int, total: int, asked: int) -> None:
    """Show the steps of the rounds before and of this one, ``total`` at most."""
    show(min(before + asked, total))


def _round(
    env: VecEnv,
    expert: Policy,
    groups: list[str],
    device: str,
    noise: float,
    successful_only: bool,
    show: Callable[[int], None],
    check: Callable[[], None],
) -> tuple[list[tuple[TensorDict, torch.Tensor]], int]:
    """Run each world's next episode to its end; return a step's observations and actions each, and the episodes.

    ``show`` is told the steps that were asked for in this round, those of episodes that will be left out among them.
    """
    obs, _ = env.reset()
    running = torch.ones(env.num_envs, dtype=torch.bool, device=env.device)
    forget = getattr(expert, "reset", lambda dones: None)
    forget(running)
    steps: list[tuple[torch.Tensor, TensorDict, torch.Tensor]] = []
    good = ~running
    asked = 0
    while bool(running.any()) and len(steps) < int(env.max_episode_length):
        actions, worlds = expert(obs), running.nonzero().flatten()
        steps.append((worlds, obs.select(*groups)[worlds], actions[worlds]))
        obs, _, dones, _ = env.step(actions + noise * torch.randn_like(actions))
        forget(dones)
        show(asked := asked + len(worlds))
        check()
        ends = running & (dones > 0)
        good |= ends & env.unwrapped.succeeded if successful_only else ends  # type: ignore
        running = running & ~ends
    pairs = [(seen[good[worlds]].to(device), actions[good[worlds]].to(device)) for worlds, seen, actions in steps]
    return [pair for pair in pairs if len(pair[1])], int(good.sum())
