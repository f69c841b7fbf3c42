# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch

from arcgym.rl.cost_advantages import discounted_advantages
from arcgym.rl.episode_costs import EpisodeCosts
from arcgym.rl.lagrange import PidMultiplier, make_multiplier


def test_ascent_moves_by_the_violation():
    """From 1 at limit 2: cost 5 adds 0.1 x 3, cost 0 takes 0.1 x 2."""
    multiplier = make_multiplier("ascent", limit=2.0, init=1.0, learning_rate=0.1)
    multiplier.update(5.0)
    assert multiplier.value == pytest.approx(1.3)
    multiplier.update(0.0)
    assert multiplier.value == pytest.approx(1.1)


@pytest.mark.parametrize("kind", ["ascent", "pid"])
def test_value_rises_above_falls_below_and_stays_in_bounds(kind):
    multiplier, values = make_multiplier(kind, limit=1.0, maximum=0.2), []
    for cost in [3.0] * 20 + [0.0] * 200:
        multiplier.update(cost)
        values.append(multiplier.value)
    assert values[:20] == sorted(values[:20])
    assert max(values) == 0.2
    assert values[-1] == 0.0


def test_pid_by_hand():
    """Limit 1, costs 3 and 5, no smoothing: errors 2 and 4, integral 0.2 and 0.6, rises 3 and 5 - 3."""
    multiplier = make_multiplier("pid", limit=1.0, init=0.0, kp=1.0, ki=0.1, kd=10.0, smoothing=0.0, delay=1)
    multiplier.update(3.0)
    assert multiplier.value == pytest.approx(2.0 + 0.2 + 30.0)
    multiplier.update(5.0)
    assert multiplier.value == pytest.approx(4.0 + 0.6 + 20.0)


def test_a_long_violation_is_not_made_up_for():
    """Ten violations of 1 would add up to 10; held at 2, one cost of 2 below the limit takes all of it."""
    multiplier = PidMultiplier(limit=2.0, init=0.0, kp=0.0, ki=1.0, kd=0.0, maximum=2.0)
    for _ in range(10):
        multiplier.update(3.0)
    assert multiplier.value == 2.0
    multiplier.update(0.0)
    assert multiplier.value == 0.0


@pytest.mark.parametrize("kind", ["ascent", "pid"])
def test_resumed_multiplier_goes_on_alike(kind):
    original = make_multiplier(kind, limit=1.0)
    for cost in (2.0, 4.0, 1.5):
        original.update(cost)
    resumed = make_multiplier(kind, limit=1.0)
    resumed.load_state_dict(original.state_dict())
    for cost in (3.0, 0.0):
        original.update(cost)
        resumed.update(cost)
        assert resumed.value == original.value


def test_fixed_never_moves():
    multiplier = make_multiplier("fixed", limit=1.0, init=0.7)
    multiplier.update(100.0)
    assert multiplier.value == 0.7


def test_settings_of_another_kind_are_left_out():
    """A configuration of the controller whose kind alone was changed."""
    price = make_multiplier("fixed", 1.0, init=2.0, kp=0.1, ki=0.01, kd=0.01, smoothing=0.95, delay=10, maximum=9.0)
    price.update(5.0)
    assert price.value == 2.0


def test_unknown_kind_lists_the_known():
    with pytest.raises(ValueError, match="'adam', expected one of: ascent, pid, fixed"):
        make_multiplier("adam", limit=1.0)


def test_episode_cost_is_the_undiscounted_sum_of_whole_episodes():
    """World 0 ends after steps 1 and 3, world 1 after step 2 only: one whole episode, of steps 2 and 3."""
    costs = EpisodeCosts(1, 2, "cpu")
    for cost, dones in (([9.0, 9.0], [1, 0]), ([1.0, 9.0], [0, 1]), ([2.5, 4.0], [1, 0])):
        assert costs.take_means() is None
        costs.add(torch.tensor([cost]), torch.tensor(dones))
    assert costs.take_means(min_episodes=2) is None
    assert costs.take_means() == [3.5]
    assert costs.take_means() is None


def test_advantages_by_hand():
    """Discount 0.5, decay 1, values zero, last value 8: 1 + 2/2 + 8/4 = 4 and 2 + 8/2 = 6; an end cuts the future."""
    signal, zeros = torch.tensor([1.0, 2.0]).view(2, 1, 1), torch.zeros(2, 1, 1)
    last = torch.tensor([[8.0]])
    assert discounted_advantages(signal, zeros, last, zeros, 0.5, 1.0).flatten().tolist() == [4.0, 6.0]
    ended = torch.tensor([0, 1]).view(2, 1, 1)
    assert discounted_advantages(signal, zeros, last, ended, 0.5, 1.0).flatten().tolist() == [2.0, 2.0]
