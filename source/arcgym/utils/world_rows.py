# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Many tensors with one entry a world, written to by one kernel: at a reset each launch counts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
import warp as wp

from arcgym.utils import world_rows_kernels as kernels


class WorldRows:
    """Sets some worlds' entries of several tensors at once. N worlds, with K numbers of four bytes each in all tensors.

    Numbers are moved bit by bit, whatever their type.
    """

    def __init__(self, tensors: Sequence[torch.Tensor]) -> None:
        """Note where the tensors are: they must stay there.

        Args:
            tensors: Shape (N, ...) each, of four dimensions at most and a type of four bytes.

        Raises:
            ValueError: If numbers have another size.
        """
        words = [_words(tensor) for tensor in tensors]
        counts = [one[0].numel() for one in words]
        self._device = str(words[0].device)
        self._views = [wp.from_torch(one) for one in words]
        firsts = np.concatenate(([0], np.cumsum(counts)[:-1]))
        rows = [_rows(view, int(first)) for view, first in zip(self._views, firsts, strict=True)]
        self._arrays = wp.array(rows, dtype=kernels.Rows, device=self._device)
        self._array_of = wp.array(np.repeat(np.arange(len(rows)), counts), dtype=int, device=self._device)

    def clear(self, env_ids: torch.Tensor) -> None:
        """Set the entries of some worlds, indices of type int64, shape (n,), to zero."""
        self._launch(kernels.clear_rows, env_ids, [])

    def copy(self, table: torch.Tensor, row: torch.Tensor, env_ids: torch.Tensor) -> None:
        """Copy rows of a table into some worlds.

        Args:
            table: As of :func:`packed`, shape (M, K), int32.
            row: Row that each world takes, shape (n,), int32.
            env_ids: World indices, shape (n,), int64.
        """
        self._launch(kernels.copy_rows, env_ids, [wp.from_torch(table), wp.from_torch(row)])

    def _launch(self, kernel: wp.Kernel, env_ids: torch.Tensor, inputs: list[wp.array]) -> None:
        inputs = [wp.from_torch(env_ids), *inputs, self._arrays, self._array_of]
        wp.launch(kernel, (len(env_ids), len(self._array_of)), inputs=inputs, device=self._device)


def packed(tensors: Sequence[torch.Tensor]) -> torch.Tensor:
    """Return tensors of shape (M, ...) side by side, as words of four bytes, shape (M, K), int32."""
    return torch.cat([_words(tensor).flatten(1) for tensor in tensors], dim=1)


def _words(tensor: torch.Tensor) -> torch.Tensor:
    """Return a view as words of four bytes, shape (N, A, B, C), int32."""
    if tensor.element_size() != 4:
        raise ValueError(f"Rows of worlds hold numbers of four bytes, but a tensor is of type {tensor.dtype}.")
    words = tensor.view(torch.int32)
    return words.view(len(words), *((1,) * (4 - words.dim())), *words.shape[1:])


def _rows(words: wp.array, first: int) -> kernels.Rows:
    rows = kernels.Rows()
    rows.words, rows.first = words, first
    return rows
