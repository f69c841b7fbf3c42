# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Random numbers that depend on their place alone: the world's seed, its control step, a tag and an index."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.func
def state_at(seed: wp.array[int], step: wp.array[int], tag: int, world: int, column: int) -> wp.uint32:
    """Return the generator's state for one number of one world."""
    state = wp.rand_init(seed[world], step[world])
    state = wp.rand_init(int(state), tag)
    return wp.rand_init(int(state), column)


@wp.kernel
def draw_uniform(
    env_ids: wp.array[wp.int64], seed: wp.array[int], step: wp.array[int], tag: int, out: wp.array2d[float]
):
    """Draw numbers from [0, 1). Launch (n, K).

    Args:
        env_ids: World indices, shape (n,).
        seed: Seed of every world's episode, shape (N,).
        step: Control step of every world's episode, shape (N,).
        tag: What the numbers are for.
        out: Numbers, shape (n, K); written.
    """
    k, column = wp.tid()
    out[k, column] = wp.randf(state_at(seed, step, tag, int(env_ids[k]), column))


@wp.kernel
def draw_normal(
    env_ids: wp.array[wp.int64], seed: wp.array[int], step: wp.array[int], tag: int, out: wp.array2d[float]
):
    """Draw numbers from the standard normal distribution; as :func:`draw_uniform`. Launch (n, K)."""
    k, column = wp.tid()
    out[k, column] = wp.randn(state_at(seed, step, tag, int(env_ids[k]), column))
