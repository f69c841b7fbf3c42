# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

import numpy as np
import pytest

from arcgym.evaluation.statistics import bootstrap, interquartile_mean, mean, paired_difference, training_runs, wilson


def test_wilson_interval_of_newcombe() -> None:
    """Newcombe, Statistics in Medicine 17 (1998), table I, method 3: 81 of 263 and 0 of 20."""
    many, none = wilson(81, 263), wilson(0, 20)
    assert (many.low, many.high) == pytest.approx((0.2553, 0.3662), abs=1e-4)
    assert (none.value, none.low, none.high) == pytest.approx((0.0, 0.0, 0.1611), abs=1e-4)


def test_an_interval_holds_its_rate() -> None:
    """Of 50 of 50 rounding made the upper end smaller than one."""
    for trials in range(1, 201):
        for successes in (0, trials // 3, trials):
            rate = wilson(successes, trials)
            assert 0.0 <= rate.low <= rate.value <= rate.high <= 1.0


def test_a_rate_without_trials_is_refused() -> None:
    with pytest.raises(ValueError, match="got 0 of 0"):
        wilson(0, 0)


@pytest.mark.parametrize(
    ("values", "mean"),
    [([1, 2, 3, 100], 2.5), ([5, 5, 5, 5, 5], 5.0), ([0, 1, 2, 3, 4, 5], (0.5 * 1 + 2 + 3 + 0.5 * 4) / 3)],
)
def test_interquartile_mean_is_of_the_middle_half(values: list[float], mean: float) -> None:
    assert interquartile_mean(np.array(values[::-1])) == pytest.approx(mean)


def test_bootstrap_interval_of_a_mean_is_that_of_theory() -> None:
    """400 values of deviation 1: 1.96 / sqrt(400) = 0.098 on either side."""
    values = np.random.default_rng(1).normal(size=400)
    values = (values - values.mean()) / values.std()
    interval = bootstrap(values, np.zeros(400), mean)
    assert (interval.value, interval.low, interval.high) == pytest.approx((0.0, -0.098, 0.098), abs=0.008)


def test_the_order_of_the_trials_does_not_matter() -> None:
    """They stand in the order in which they ended, which the number of worlds decides."""
    rng = np.random.default_rng(2)
    values, runs = rng.normal(size=30), np.repeat([0, 1, 2], 10)
    order = rng.permutation(30)
    assert bootstrap(values[order], runs[order]) == bootstrap(values, runs)
    assert paired_difference(values[order], -values[order], runs[order]) == paired_difference(values, -values, runs)


def test_training_runs_are_drawn_anew() -> None:
    """Two runs, one always 0 and one always 1: of four draws one has the first twice, one the second twice."""
    values = np.repeat([0.0, 1.0], 10)
    interval = bootstrap(values, values, mean)
    assert (interval.value, interval.low, interval.high) == (0.5, 0.0, 1.0)


def test_runs_of_unequal_numbers_of_trials_are_all_drawn() -> None:
    """Nine trials of a run that gives 1, one of another that gives 3: both runs are as likely."""
    interval = bootstrap(np.array([1.0] * 9 + [3.0]), np.array([0] * 9 + [1]), mean)
    assert (interval.value, interval.low, interval.high) == pytest.approx((1.2, 1.0, 3.0))


def test_training_runs_are_checkpoints_counted_within_their_task() -> None:
    rows = [{"task": task, "agent": f"{task}/{seed}.pt", "group": 0} for task in ("a", "b") for seed in (1, 2)]
    assert training_runs(rows).tolist() == [0, 1, 0, 1]
    assert training_runs([{"task": "a", "agent": "zero", "group": k} for k in range(3)]).tolist() == [0, 0, 0]
    assert training_runs([{"task": "a", "group": k} for k in (2, 1)]).tolist() == [1, 0]


def test_paired_difference_removes_what_trials_have_in_common() -> None:
    hard = np.linspace(0.0, 100.0, 50)
    interval = paired_difference(hard, hard + 1.0, np.zeros(50))
    assert (interval.value, interval.low, interval.high) == pytest.approx((1.0, 1.0, 1.0))
