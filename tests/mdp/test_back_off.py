# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Going back where a scope no longer comes on: a wait of three steps and two steps back, of 0.1 s each."""

from __future__ import annotations

import pytest
import torch

from arcgym.envs.mdp.back_off import BackOff


@pytest.fixture
def back_off() -> BackOff:
    return BackOff(after=0.3, duration=0.2, step_dt=0.1, num_envs=2, device="cpu")


def steps(back_off: BackOff, lengths: list[tuple[float, float]]) -> list[list[bool]]:
    """Return which of the two worlds go back in each of some control steps, which begin with these lengths [m]."""
    found = []
    for length in lengths:
        back_off.advance(torch.tensor(length))
        found.append(back_off.active.tolist())
    return found


def first(found: list[list[bool]]) -> list[int]:
    return [int(active) for active, _ in found]


def test_a_scope_that_stands_still_waits_goes_back_and_waits_again(back_off: BackOff) -> None:
    """With 0.4 m inside from the start, as in a start state: three steps forward, two back, three forward, two back."""
    found = steps(back_off, [(0.4, 0.0)] * 10)
    assert first(found) == [0, 0, 0, 1, 1, 0, 0, 0, 1, 1]
    assert [inside for _, inside in found] == [bool(inside) for inside in first(found)]  # and with nothing inside


def test_a_scope_that_comes_on_by_more_than_5_mm_does_not_go_back(back_off: BackOff) -> None:
    """The first world has 6 mm more in every third step; the second comes on by 2 mm a step, 6 mm in three."""
    lengths = [(0.1 + 0.006 * (step // 3), 0.1 + 0.002 * step) for step in range(12)]
    assert not any(map(any, steps(back_off, lengths)))


def test_a_scope_that_creeps_or_slides_to_and_fro_goes_back(back_off: BackOff) -> None:
    """1 mm a step is 3 mm in three; the second world swings by 4 mm, or is being drawn back by the policy."""
    assert steps(back_off, [(0.1 + 0.001 * step, 0.1 + 0.004 * (step % 2)) for step in range(4)])[3] == [True, True]
    back_off.reset()
    assert first(steps(back_off, [(0.1 - 0.01 * step, 0.0) for step in range(4)])) == [0, 0, 0, 1]


def test_it_comes_on_from_where_it_has_gone_back_to(back_off: BackOff) -> None:
    """Back from 0.40 to 0.38 m, then 6 mm forward: that is on, although less than 0.40 m."""
    inside = [0.4, 0.4, 0.4, 0.4, 0.39, 0.38, 0.386, 0.386, 0.386, 0.386]
    assert first(steps(back_off, [(length, 0.0) for length in inside])) == [0, 0, 0, 1, 1, 0, 0, 0, 0, 1]


def test_reset_lets_one_world_wait_anew(back_off: BackOff) -> None:
    """In the second step back; the other goes on with its own, and a shorter length inside is no less of a start."""
    assert steps(back_off, [(0.4, 0.4)] * 5)[4] == [True, True]
    back_off.reset(torch.tensor([0]))
    found = steps(back_off, [(0.2, 0.4)] * 5)
    assert found == [[False, False], [False, False], [False, False], [True, True], [True, True]]
    back_off.reset(None)
    assert first(steps(back_off, [(0.0, 0.0)] * 4)) == [0, 0, 0, 1]


def test_a_time_below_half_a_step_is_a_step() -> None:
    back_off = BackOff(after=0.01, duration=0.01, step_dt=0.1, num_envs=2, device="cpu")
    assert first(steps(back_off, [(0.4, 0.4)] * 4)) == [0, 1, 0, 1]
