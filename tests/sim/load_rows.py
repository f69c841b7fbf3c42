# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rows of the links' loads, as a warp of a GPU reads them, from and to the arrays of the plain kernels."""

from __future__ import annotations

import numpy as np

from arcgym.sim.scope.load_row_kernels import LoadRows

PLACES = [(0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)]
"""Elements of a symmetric matrix in the order of a row."""


def write_rows(rows: LoadRows, ll: np.ndarray, la: np.ndarray, aa: np.ndarray, wrench: np.ndarray) -> None:
    """Write loads of shape (L, W, 3, 3), wrenches (L, W, 6); links without any get a row that is not valid."""
    links, worlds = wrench.shape[:2]
    out = np.zeros((worlds, links, 32), np.float32)
    at = tuple(np.transpose(PLACES))
    parts = [-wrench[..., :3], ll[..., at[0], at[1]], la.reshape(links, worlds, 9), -wrench[..., 3:]]
    parts.append(aa[..., at[0], at[1]])
    out[..., :27] = np.concatenate(parts, axis=-1).swapaxes(0, 1)
    loaded = out.any(axis=-1)
    out[~loaded] = np.nan
    rows.fours.assign(out.reshape(-1, 4))
    rows.loaded.assign(loaded.ravel().astype(np.int32))


def read_rows(rows: LoadRows, worlds: int) -> dict[str, np.ndarray]:
    """Return ``ll``, ``la``, ``aa``, shape (L, W, 3, 3), and ``wrench``, (L, W, 6); zeros where none is valid."""
    row = rows.fours.numpy().reshape(worlds, -1, 32).swapaxes(0, 1).copy()
    row[rows.loaded.numpy().reshape(worlds, -1).T == 0] = 0.0

    def symmetric(values: np.ndarray) -> np.ndarray:
        out = np.zeros((*values.shape[:2], 3, 3), np.float32)
        for k, (i, j) in enumerate(PLACES):
            out[..., i, j] = out[..., j, i] = values[..., k]
        return out

    la = row[..., 9:18].reshape(*row.shape[:2], 3, 3)
    wrench = -np.concatenate([row[..., :3], row[..., 18:21]], axis=-1)
    return {"ll": symmetric(row[..., 3:9]), "la": la, "aa": symmetric(row[..., 21:27]), "wrench": wrench}
