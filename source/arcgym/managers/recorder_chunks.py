# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Chunks of recordings, compressed beside each other: HDF5 itself compresses one after the other."""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

LEVEL = 1
"""Level of gzip: higher ones take several times as long for a few percent."""
LEAST_BYTES = 1 << 16
"""Size of the smallest array that is worth handing to another thread [byte]."""


def pack(rows: np.ndarray, count: int) -> bytes:
    """Return what HDF5 stores of a chunk with filters shuffle, for values of several bytes, and gzip.

    Args:
        rows: First values of the chunk, shape (T, ...); the rest of it is zero.
        count: Rows of a chunk, at least T.
    """
    chunk = np.zeros((count, *rows.shape[1:]), rows.dtype)
    chunk[: len(rows)] = rows
    bytes_of_values = chunk.reshape(-1).view(np.uint8).reshape(-1, chunk.itemsize)
    return zlib.compress(bytes_of_values.T.tobytes(), LEVEL)


def pack_together(episodes: Sequence[Mapping[str, np.ndarray]], count: int) -> list[dict[str, bytes]]:
    """Pack the large arrays of several episodes, on all cores.

    Args:
        episodes: Values of steps by name, each of shape (T, ...).
        count: Rows of a chunk, at least T.

    Returns:
        Chunks by name of each episode, see :func:`pack`; small arrays are left out.
    """
    large = [(k, name) for k, steps in enumerate(episodes) for name in steps if steps[name].nbytes >= LEAST_BYTES]
    packed: list[dict[str, bytes]] = [{} for _ in episodes]
    if large:
        with ThreadPoolExecutor() as pool:
            chunks = pool.map(lambda item: pack(episodes[item[0]][item[1]], count), large)
            for (k, name), chunk in zip(large, chunks, strict=True):
                packed[k][name] = chunk
    return packed


def write_chunk(dataset: Any, row: int, chunk: bytes) -> None:
    """Put a packed chunk into a dataset that is long enough, from a row on where a chunk begins."""
    dataset.id.write_direct_chunk((row, *(0 for _ in dataset.shape[1:])), chunk)
