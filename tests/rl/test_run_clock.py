# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""When a run has had its share of time and transitions."""

from __future__ import annotations

from arcgym.rl.run_clock import RunClock


def test_a_run_ends_with_the_transitions_that_it_may_take():
    """60 of 100 transitions in 30 of 600 seconds: the larger share counts; 110 are enough, also after a restart."""
    clock = RunClock(max_minutes=10.0, max_transitions=100)
    clock.add(30.0, 60)
    assert clock.fraction == 0.6 and not clock.is_over
    clock.add(30.0, 50)
    again = RunClock(max_transitions=100)
    again.restore(clock.state())
    assert clock.is_over and again.is_over
    assert f"{again}, {again.limit}" == "1.0 minutes and 110 transitions, max_transitions"


def test_a_run_ends_with_its_minutes():
    clock = RunClock(max_minutes=1.0, max_transitions=100)
    clock.add(61.0, 10)
    assert clock.is_over and clock.limit == "max_minutes"
