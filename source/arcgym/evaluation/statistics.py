# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Statistics of evaluations: intervals that small numbers of trials allow."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

CONFIDENCE = 0.95
"""Coverage of all intervals."""
Z = 1.959964
"""Quantile of the normal distribution at (1 + CONFIDENCE) / 2."""
RESAMPLES = 2000
"""Bootstrap samples; our choice."""

Statistic = Callable[[np.ndarray], np.ndarray]
"""From samples, shape (..., n), to one number of each, shape (...)."""


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
    return Interval(rate, min(max(middle - half, 0.0), rate), max(min(middle + half, 1.0), rate))  # no rounding beyond


def mean(values: np.ndarray) -> np.ndarray:
    """Return the mean of samples, shape (..., n), as (...)."""
    return np.mean(values, axis=-1)


def interquartile_mean(values: np.ndarray) -> np.ndarray:
    """Return the mean of the middle half of samples, shape (..., n), as (...); values on its border count in part."""
    ordered = np.sort(np.asarray(values, float), axis=-1)
    n = ordered.shape[-1]
    edges = np.arange(n + 1)
    share = np.clip(np.minimum(edges[1:], 0.75 * n) - np.maximum(edges[:-1], 0.25 * n), 0.0, 1.0)
    return ordered @ share / share.sum()


def training_runs(rows: Sequence[dict[str, Any]]) -> np.ndarray:
    """Return the number of the training run that each row is of, shape (n,), counted within each task.

    Checkpoints are training runs, where rows name their agent, else groups of trials are. An agent that was not trained
    is one run.
    """
    runs = [str(row.get("agent", row["group"])) for row in rows]
    of_task: dict[str, set[str]] = {}
    for row, run in zip(rows, runs, strict=True):
        of_task.setdefault(row["task"], set()).add(run)
    known = {task: sorted(members) for task, members in of_task.items()}
    return np.array([known[row["task"]].index(run) for row, run in zip(rows, runs, strict=True)])


def bootstrap(
    values: np.ndarray, runs: np.ndarray, statistic: Statistic = interquartile_mean, seed: int = 0
) -> Interval:
    """Return a statistic with its percentile interval.

    Training runs are drawn anew, as Agarwal et al. do (Deep RL at the edge of the statistical precipice, NeurIPS 2021),
    and trials within each run that was drawn: the interval is that of the method, not of the runs at hand. Of one run
    only trials can be drawn, and the interval is that of this run. It does not depend on the order of the trials, which
    is that in which they ended.

    Args:
        values: One value a trial, shape (n,).
        runs: Training run of each trial, shape (n,). A run that is drawn gives as many trials as runs have on average.
        statistic: Of all values together.
        seed: Seed of the draws.
    """
    rng = np.random.default_rng(seed)
    order = np.lexsort((values, runs))
    values, runs = values[order], runs[order]
    members = [np.flatnonzero(runs == run) for run in np.unique(runs)]
    count = max(round(len(values) / len(members)), 1)
    drawn = rng.integers(len(members), size=(RESAMPLES, len(members)))
    trials = np.empty((RESAMPLES, len(members), count), int)
    for run, places in enumerate(members):
        chosen = drawn == run
        trials[chosen] = rng.choice(places, (int(chosen.sum()), count))
    tail = 100 * (1 - CONFIDENCE) / 2
    low, high = np.percentile(statistic(values[trials.reshape(RESAMPLES, -1)]), [tail, 100 - tail])
    return Interval(float(statistic(values)), float(low), float(high))


def paired_difference(first: np.ndarray, second: np.ndarray, runs: np.ndarray, seed: int = 0) -> Interval:
    """Return the mean of ``second - first`` over the same trials, with its bootstrap interval.

    Args:
        first: Values of one agent by trial, shape (n,).
        second: Values of the other in the same trials, shape (n,).
        runs: Pair of training runs of each trial, shape (n,).
        seed: Seed of the draws.
    """
    return bootstrap(second - first, runs, mean, seed)
