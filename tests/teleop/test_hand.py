# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Which command keys, sticks, buttons and sliders give, with a clock that the test sets."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.teleop.hand import HOLD, TIMEOUT, Hand

PUSHED = ("insertion", "roll", "pitch", "yaw")
PULLED = ("right", "up", "forward", "pitch", "yaw", "roll")


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_keys() -> None:
    hand = Hand(PUSHED)
    np.testing.assert_allclose(hand.from_keys(["KeyW", "KeyL"]), [0.6, 0.0, 0.0, -0.6], rtol=1e-6)
    np.testing.assert_allclose(hand.from_keys(["KeyS", "KeyW", "KeyQ", "ShiftLeft"]), [0.0, -1.0, 0.0, 0.0])
    np.testing.assert_allclose(Hand(PULLED).from_keys(["KeyD", "KeyF"]), [0.6, -0.6, 0, 0, 0, 0], rtol=1e-6)


def test_sliders_of_the_robot_before_command_nothing() -> None:
    """Four sliders of a pushed scope are still on the page while a capsule of six axes is loaded."""
    hand = Hand(PULLED)
    hand.command("sliders", np.full(4, 0.5))
    assert hand.value().tolist() == [0.0] * 6


def test_gamepads() -> None:
    pad = {"axes": [0.5, -1.0, 0.05, 0.25], "buttons": [0, 0, 0, 0, 0, 1.0, 0.2, 0.7]}
    np.testing.assert_allclose(Hand(PUSHED).from_pad(pad), [1.0, 0.5, -0.25, 0.0])
    np.testing.assert_allclose(Hand(PULLED).from_pad(pad), [0.5, 0.5, 1.0, -0.25, 0.0, 1.0], atol=1e-6)
    assert not Hand(PUSHED).from_pad({}).any()


def test_the_source_that_moved_last_leads(clock) -> None:
    hand = Hand(("insertion",), clock)
    hand.command("one", np.array([0.3]))
    clock.now += 0.1
    hand.command("two", np.array([-0.4]))
    clock.now += 0.1
    hand.command("one", np.array([0.3]))  # says the same again
    assert hand.value() == pytest.approx([-0.4])
    hand.command("two", np.array([0.0]))
    assert hand.value() == pytest.approx([0.3])
    hand.drop("one")
    assert not hand.value().any()


def test_commands_end(clock) -> None:
    hand = Hand(PUSHED, clock)
    hand.push("button", "pitch", -1.0)
    assert hand.value() == pytest.approx([0.0, 0.0, -0.6, 0.0])
    clock.now += HOLD + 0.01
    assert not hand.value().any()


def test_dead_man(clock) -> None:
    hand = Hand(PUSHED, clock)
    hand.command("sliders", np.array([2.0, 0.0, 0.0, 0.0]))
    clock.now += TIMEOUT - 0.1
    assert hand.value()[0] == 1.0 and hand.is_alive
    hand.touch()
    clock.now += TIMEOUT - 0.1
    assert hand.value()[0] == 1.0
    clock.now += 0.2
    assert not hand.is_alive and not hand.value().any()
    hand.touch()
    assert not hand.value().any()


def test_a_gamepad_that_says_no_number_commands_nothing() -> None:
    """A command that is no number would break the world."""
    hand = Hand(PUSHED)
    hand.command("pad", np.array([np.nan, 0.5, np.inf, 0.0]))
    assert hand.value().tolist() == [0.0, 0.5, 1.0, 0.0]
