# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Statistics of evaluations: intervals that small numbers of trials allow."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

CONFIDENCE = 0.95
"""Coverage of all intervals."""
Z = 1.959964
"""Quantile of the normal distribution at (1 + CONFIDENCE) / 2."""
RESAMPLES = 2000
"""Bootstrap samples, as in Agarwal et al., Deep RL at the edge of the statistical precipice, NeurIPS 2021."""


@dataclass(frozen=True)
class Interval:
    """An estimate with the bounds of its interval."""

    value: float
    """Estimate."""
    low: float
    """Lower bound."""
    high: float
    """Upper bound."""


def wilson(successes: int, trials: int) -> Interval:
    """Return a success rate with Wilson's score interval (Wilson, JASA 22, 1927).

    Args:
        successes: Trials that succeeded.
        trials: All trials.

    Raises:
        ValueError: If there is no trial, or more successes than trials.
    """
    if not 0 <= successes <= trials or trials == 0:
        raise ValueError(f"A rate needs 0 <= successes <= trials and a trial; got {successes} of {trials}.")
    rate, z2 = successes / trials, Z * Z
    middle = (rate + z2 / (2 * trials)) / (1 + z2 / trials)
    half = Z * math.sqrt(rate * (1 - rate) / trials + z2 / (4 * trials**2)) / (1 + z2 / trials)
    return Interval(rate, max(middle - half, 0.0), min(middle + half, 1.0))


def interquartile_mean(values: np.ndarray) -> float:
    """Return the mean of the middle half of values, shape (n,); values on its border count in part."""
    ordered = np.sort(np.asarray(values, float))
    n = len(ordered)
    edges = np.arange(n + 1)
    share = np.clip(np.minimum(edges[1:], 0.75 * n) - np.maximum(edges[:-1], 0.25 * n), 0.0, 1.0)
    return float(share @ ordered / share.sum())


def bootstrap(
    values: np.ndarray,
    groups: np.ndarray,
    statistic: Callable[[np.ndarray], float] = interquartile_mean,
    seed: int = 0,
) -> Interval:
    """Return a statistic with its percentile interval, trials drawn anew within each group.

    Args:
        values: One value a trial, shape (n,).
        groups: Training seed of each trial, shape (n,): every one keeps its number of trials.
        statistic: Of all values together.
        seed: Seed of the draws.
    """
    rng = np.random.default_rng(seed)
    strata = [np.flatnonzero(groups == group) for group in np.unique(groups)]
    drawn = [
        statistic(values[np.concatenate([rng.choice(members, len(members)) for members in strata])])
        for _ in range(RESAMPLES)
    ]
    tail = 100 * (1 - CONFIDENCE) / 2
    low, high = np.percentile(drawn, [tail, 100 - tail])
    return Interval(statistic(values), float(low), float(high))


def paired_difference(first: np.ndarray, second: np.ndarray, groups: np.ndarray, seed: int = 0) -> Interval:
    """Return the mean of ``second - first`` over the same trials, with its bootstrap interval.

    Args:
        first: Values of one agent by trial, shape (n,).
        second: Values of the other in the same trials, shape (n,).
        groups: Training seed of each trial, shape (n,).
        seed: Seed of the draws.
    """
    return bootstrap(second - first, groups, lambda values: float(np.mean(values)), seed)
