# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Writes into many arrays at once, in some worlds. n worlds are written to, K words of four bytes in each."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class Rows:
    """One array of all N worlds."""

    words: wp.array4d[int]
    """What it holds, as words of four bytes, shape (N, A, B, C)."""
    first: int
    """Number of its first word among those of a world in all arrays."""


@wp.func
def put(arrays: wp.array[Rows], array_of: wp.array[int], world: int, column: int, word: int):
    """Write one of the K words of a world."""
    rows = arrays[array_of[column]]
    place, middle, last = column - rows.first, rows.words.shape[2], rows.words.shape[3]
    rows.words[world, place // (middle * last), (place // last) % middle, place % last] = word


@wp.kernel
def clear_rows(env_ids: wp.array[wp.int64], arrays: wp.array[Rows], array_of: wp.array[int]):
    """Set all words of some worlds to zero. Launch (n, K).

    Args:
        env_ids: World indices, shape (n,).
        arrays: The arrays; written.
        array_of: Array that each word of a world belongs to, shape (K,).
    """
    k, column = wp.tid()
    put(arrays, array_of, int(env_ids[k]), column, 0)


@wp.kernel
def copy_rows(
    env_ids: wp.array[wp.int64],
    source: wp.array2d[int],
    row: wp.array[int],
    arrays: wp.array[Rows],
    array_of: wp.array[int],
):
    """Copy rows of a table into some worlds. Launch (n, K).

    Args:
        env_ids: World indices, shape (n,).
        source: The table, shape (M, K).
        row: Row that each world takes, shape (n,).
        arrays: The arrays; written.
        array_of: Array that each word of a world belongs to, shape (K,).
    """
    k, column = wp.tid()
    put(arrays, array_of, int(env_ids[k]), column, source[row[k], column])
