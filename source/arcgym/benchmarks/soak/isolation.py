# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Whether worlds leave each other alone, and whether a broken one is caught."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from unittest.mock import patch

import torch
import warp as wp

from arcgym.benchmarks.worlds import advance


class ResetGuard:
    """Compares, at every reset, the state of the other worlds before and after it, bit by bit."""

    def __init__(self, env: Any) -> None:
        """Start with no world disturbed."""
        self._env = env
        self.resets = torch.zeros((), dtype=torch.long, device=env.device)
        """Worlds that were reset."""
        self.disturbed = torch.zeros((), dtype=torch.long, device=env.device)
        """Worlds that another world's reset changed."""
        self.before: Callable[[], None] = lambda: None
        """Called before every reset."""

    @contextmanager
    def watch(self) -> Iterator[None]:
        """Watch the environment's resets for a while."""
        reset = self._env._reset_idx

        def watched(env_ids: torch.Tensor) -> None:
            self.before()
            before = copied(self._env.sim)
            reset(env_ids)
            changed = different(before, self._env.sim.world_arrays())
            changed[env_ids] = False
            self.disturbed += changed.sum()
            self.resets += len(env_ids)

        with patch.object(self._env, "_reset_idx", watched):
            yield


@torch.no_grad()
def neighbors_disturbed(env: Any, actions: torch.Tensor) -> int:
    """Count worlds whose next control step differs, in any bit, if the first world is reset before it.

    The same step is made three times from the same state: as it is, again, which must change no world, and after a
    reset of world 0, which may change world 0 alone. The state is put back.

    Args:
        env: The environment.
        actions: Actions of the step, shape (N, A).
    """
    start = copied(env.sim)
    ends = []
    for reset_first in (False, False, True):
        restore(env.sim, start)
        if reset_first:
            env.sim.write_snapshot(-1, [0])
            env.sim.forward()
        advance(env, actions)
        ends.append(copied(env.sim))
    restore(env.sim, start)
    repeated, reset = different(ends[0], ends[1]), different(ends[0], ends[2])
    reset[0] = False
    return int((repeated | reset).sum())


@torch.no_grad()
def breakage_caught(env: Any) -> list[str]:
    """Break the first world with a NaN, make a step and return what is wrong afterwards; empty if nothing is."""
    failures = env.world_failures
    env.scene["colon"].data.nodal_pos_w[0, 0, 0] = float("nan")
    obs, reward, terminated, *_ = env.step(
        torch.zeros(env.num_envs, env.action_manager.total_action_dim).to(env.device)
    )
    problems = []
    if env.world_failures != failures + 1:
        problems.append(f"{env.world_failures - failures} worlds counted as recovered, expected 1")
    recovered = (terminated & env.failed).nonzero().flatten().tolist()
    if recovered != [0]:
        problems.append(f"worlds {recovered} terminated for it, expected [0]")
    found = {**leaves("obs", obs), "reward": reward, **env.sim.world_arrays()}
    problems += [f"{name} is not finite" for name, value in found.items() if not bool(torch.isfinite(value).all())]
    return problems


def leaves(name: str, value: Any) -> dict[str, torch.Tensor]:
    """Return the tensors of floats in nested dictionaries, by the path of their names."""
    if isinstance(value, dict):
        return {path: leaf for key, item in value.items() for path, leaf in leaves(f"{name}/{key}", item).items()}
    return {name: value} if isinstance(value, torch.Tensor) and value.is_floating_point() else {}


def copied(sim: Any) -> dict[str, torch.Tensor]:
    """Copy of all that the worlds' future depends on."""
    return {name: array.clone() for name, array in sim.world_arrays().items()}


def restore(sim: Any, arrays: dict[str, torch.Tensor]) -> None:
    """Put the worlds back, with solvers that remember nothing."""
    for name, array in sim.world_arrays().items():
        array.copy_(arrays[name])
    sim.coupling.reset(wp.full(sim.num_envs + 1, True, dtype=bool, device=sim.device))
    sim.forward()


def different(one: dict[str, torch.Tensor], other: dict[str, torch.Tensor]) -> torch.Tensor:
    """Return the worlds in which any number differs, bool, shape (N,). NaN equals NaN."""
    worlds = []
    for name, a in one.items():
        b = other[name]
        unequal = (a != b) & ~((a != a) & (b != b))
        worlds.append(unequal.flatten(1).any(dim=1))
    return torch.stack(worlds).any(dim=0)
