# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Shafts of 41 links drawn in the front view, for tests of loops."""

from __future__ import annotations

import numpy as np
import torch


def line(start: tuple[float, float], end: tuple[float, float], count: int = 10) -> np.ndarray:
    """Points from one place of the front view (x, z) to another, without the last."""
    return np.linspace(start, end, count, endpoint=False)


def up_and_round(depth: float) -> torch.Tensor:
    """A shaft that goes up, turns right through three quarters of a circle, and crosses itself ``depth`` in front."""
    turn = np.linspace(0.0, 1.5 * np.pi, 20, endpoint=False)
    circle = np.stack([0.05 - 0.05 * np.cos(turn), 0.15 + 0.05 * np.sin(turn)], 1)
    plane = np.concatenate([line((0.0, 0.01), (0.0, 0.15)), circle, line((0.05, 0.10), (-0.10, 0.10), 11)])
    forward = np.linspace(0.0, depth, len(plane))
    return torch.tensor(np.stack([plane[:, 0], forward, plane[:, 1]], 1), dtype=torch.float32)


def zigzag(drop: float) -> torch.Tensor:
    """A shaft that rises to 20 cm, comes down by ``drop`` and rises again, without a crossing; as long as the other."""
    top = (0.0, 0.20)
    low = (0.03, 0.20 - drop)
    plane = np.concatenate([line((0.0, 0.01), top, 14), line(top, low, 14), line(low, (0.06, 0.30), 13)])
    return torch.tensor(np.stack([plane[:, 0], 0.0 * plane[:, 0], plane[:, 1]], 1), dtype=torch.float32)
