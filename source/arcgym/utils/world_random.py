# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Random numbers of an environment, a stream of its own for every world."""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable

import numpy as np
import torch
import warp as wp

from arcgym.utils import random_kernels
from arcgym.utils.transfer import send
from arcgym.utils.worlds import fill_worlds

SeedSource = Callable[[torch.Tensor], torch.Tensor]
"""Gives the seeds of episodes: from world indices on the CPU, int64, shape (n,), to seeds below 2^31, shape (n,)."""


class WorldRandom:
    """Random numbers that depend on nothing but the episode's seed, the control step, and what they are for.

    The same episode seed gives the same numbers in every world, whatever the number of worlds and whatever happens in
    the others. Numbers are a hash of their place (Warp's PCG, Jarzynski and Olano, JCGT 9(3), 2020), so that nothing is
    used up: the same tag in the same control step gives the same numbers again.

    By default the seeds of a world's episodes follow from the seed of the environment, the world's index and the number
    of episodes that it began; :attr:`seed_source` gives others.
    """

    def __init__(self, num_envs: int, device: str, seed: int) -> None:
        """Begin the first episodes.

        Args:
            num_envs: Number of worlds N.
            device: Device of the numbers.
            seed: Seed of the environment.
        """
        wp.init()
        self.num_envs, self.device = num_envs, device
        self.seed_source: SeedSource | None = None
        """Seeds of the episodes that begin from now on; None for those that follow from the environment's seed."""
        self._worlds = torch.arange(num_envs, device=device)
        self._cpu_worlds = torch.arange(num_envs)
        self._seed = torch.zeros(num_envs, dtype=torch.int32)
        self._step = torch.zeros(num_envs, dtype=torch.int32)
        self._device_seed = self._seed.to(device, copy=True)
        self._device_step = self._step.to(device, copy=True)
        self._places = {
            "cpu": [wp.from_torch(self._seed), wp.from_torch(self._step)],
            device: [wp.from_torch(self._device_seed), wp.from_torch(self._device_step)],
        }
        self.reseed(seed)

    @property
    def episode_seed(self) -> torch.Tensor:
        """Seed of every world's episode, on the CPU, int32, shape (N,)."""
        return self._seed

    def reseed(self, seed: int) -> None:
        """Begin with another seed of the environment; the episodes under way get new seeds, too."""
        self._base = seed
        self._episodes = np.zeros(self.num_envs, np.int64)
        self._give(self._cpu_worlds, self._following(self._cpu_worlds))

    def begin(self, env_ids: torch.Tensor) -> None:
        """Begin an episode in some worlds, with its seed and at step zero.

        Args:
            env_ids: World indices, int64, shape (n,); those on the CPU are not waited for.
        """
        ids = env_ids.cpu()
        self._episodes[ids.numpy()] += 1
        self._give(ids, self._following(ids) if self.seed_source is None else self.seed_source(ids))

    def advance(self) -> None:
        """Count a control step in every world."""
        self._step += 1
        self._device_step += 1

    def uniform(self, tag: str, *shape: int, env_ids: torch.Tensor | None = None, on_cpu: bool = False) -> torch.Tensor:
        """Return numbers from [0, 1), float32, shape (n, ...).

        Args:
            tag: What they are for: other tags give other numbers.
            shape: Shape for each world.
            env_ids: World indices, int64, shape (n,); None for all.
            on_cpu: Whether the numbers are made on the CPU, for what lives there.
        """
        return self._draw(random_kernels.draw_uniform, tag, shape, env_ids, on_cpu)

    def normal(self, tag: str, *shape: int, env_ids: torch.Tensor | None = None) -> torch.Tensor:
        """Return numbers from the standard normal distribution; arguments as of :meth:`uniform`."""
        return self._draw(random_kernels.draw_normal, tag, shape, env_ids, False)

    def integers(self, tag: str, low: int, high: int, *shape: int, env_ids: torch.Tensor | None = None) -> torch.Tensor:
        """Return integers from ``low`` to ``high - 1``, int64, shape (n, ...); see :meth:`uniform`."""
        span = (self.uniform(tag, *shape, env_ids=env_ids) * (high - low)).long()
        return low + span.clamp(max=high - low - 1)

    def _draw(
        self, kernel: wp.Kernel, tag: str, shape: tuple[int, ...], env_ids: torch.Tensor | None, on_cpu: bool
    ) -> torch.Tensor:
        device = "cpu" if on_cpu else self.device
        worlds = self._worlds if env_ids is None else env_ids
        if on_cpu:
            worlds = self._cpu_worlds if env_ids is None else env_ids.cpu()
        columns = math.prod(shape)
        out = torch.empty((len(worlds), columns), device=device)
        if out.numel():
            inputs = [wp.from_torch(worlds), *self._places[device], _number_of(tag)]
            wp.launch(kernel, out.shape, inputs=inputs, outputs=[wp.from_torch(out)], device=device)
        return out.view(len(worlds), *shape)

    def _give(self, ids: torch.Tensor, seeds: torch.Tensor) -> None:
        """Write the seeds of episodes that begin; indices on the CPU."""
        self._seed[ids] = seeds.to(torch.int32)
        self._step[ids] = 0
        where, sent = send(torch.stack([ids, self._seed[ids].long()]), self.device)
        self._device_seed[where] = sent.int()
        fill_worlds(self._device_step, where, 0)

    def _following(self, ids: torch.Tensor) -> torch.Tensor:
        """Return seeds made of the environment's seed, the worlds' indices and their numbers of episodes."""
        worlds = ids.numpy()
        return torch.from_numpy(episode_seeds(self._base, worlds, self._episodes[worlds]))


def episode_seeds(base: int, worlds: np.ndarray, episodes: np.ndarray) -> np.ndarray:
    """Return a seed below 2^31 for every world's episode, int32, shape (n,), by SplitMix64 (Steele et al., 2014).

    Args:
        base: Seed of the environment.
        worlds: World indices, shape (n,).
        episodes: Numbers of episodes that they began, shape (n,).
    """
    with np.errstate(over="ignore"):
        z = _mix(np.full(len(worlds), base % 2**63, np.uint64))
        z = _mix(z + worlds.astype(np.uint64))
        z = _mix(z + episodes.astype(np.uint64))
    return (z >> np.uint64(33)).astype(np.int32)


def _mix(z: np.ndarray) -> np.ndarray:
    """Return one step of SplitMix64 of each number, uint64."""
    z = z + np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def _number_of(tag: str) -> int:
    """Return a number below 2^31 for a tag, the same in every process."""
    return zlib.crc32(tag.encode()) & 0x7FFFFFFF
