# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Statistics of a feature, by which learners normalize it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class FeatureStats:
    """Least, largest, mean and standard deviation of each entry over ``count`` frames."""

    min: np.ndarray
    """Least value, in the shape of the statistics."""
    max: np.ndarray
    """Largest value."""
    mean: np.ndarray
    """Mean."""
    std: np.ndarray
    """Standard deviation."""
    count: int
    """Frames."""

    @staticmethod
    def of(values: np.ndarray) -> FeatureStats:
        """Return the statistics of frames, shape (S, D) or (S,); theirs have shape (D,) or (1,)."""
        rows = values.reshape(len(values), -1).astype(np.float64)
        return FeatureStats(rows.min(axis=0), rows.max(axis=0), rows.mean(axis=0), rows.std(axis=0), len(rows))

    @staticmethod
    def of_images(images: np.ndarray) -> FeatureStats:
        """Return the statistics of each color, 0 to 1, of pictures of shape (S, H, W, 3); theirs have (3, 1, 1)."""
        one = FeatureStats.of(images.reshape(-1, 3) / 255.0)
        least, largest, mean, std = (value.reshape(3, 1, 1) for value in (one.min, one.max, one.mean, one.std))
        return FeatureStats(least, largest, mean, std, len(images))

    def plain(self) -> dict[str, Any]:
        """Return the statistics as lists."""
        values = {name: getattr(self, name).tolist() for name in ("min", "max", "mean", "std")}
        return values | {"count": [self.count]}


def merged(episodes: Sequence[dict[str, FeatureStats]]) -> dict[str, FeatureStats]:
    """Return the statistics of each feature over all frames of several episodes."""
    return {name: _merge([one[name] for one in episodes]) for name in episodes[0]}


def _merge(parts: Sequence[FeatureStats]) -> FeatureStats:
    weight = np.array([part.count for part in parts], float) / sum(part.count for part in parts)
    share = weight.reshape(-1, *[1] * parts[0].mean.ndim)
    mean = (share * np.stack([part.mean for part in parts])).sum(axis=0)
    square = (share * np.stack([part.std**2 + part.mean**2 for part in parts])).sum(axis=0)
    return FeatureStats(
        np.min([part.min for part in parts], axis=0),
        np.max([part.max for part in parts], axis=0),
        mean,
        np.sqrt(np.maximum(square - mean**2, 0.0)),
        sum(part.count for part in parts),
    )
