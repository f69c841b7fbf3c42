# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""When loops of a pushed scope are straightened: two worlds, a slack of 10 cm, tips that may slip by 2 and 5 cm."""

from __future__ import annotations

import pytest
import torch

from arcgym.experts.loops import AGAIN, LONGEST, Loops


@pytest.fixture
def loops() -> Loops:
    """Both worlds have had 0.38 m of scope inside where the tip was at 0.40 m."""
    loops = Loops(2, "cpu", torch.full((2,), 0.1), torch.tensor([0.02, 0.05]))
    assert look(loops, [0.40, 0.40], [0.38, 0.38]) == ([False, False], [False, False])
    return loops


def look(loops: Loops, arc: list[float], inserted: list[float]) -> tuple[list[bool], list[bool]]:
    """Return which worlds straighten, and which begin to."""
    on, begins = loops.update(torch.tensor(arc), torch.tensor(inserted))
    return on.tolist(), begins.tolist()


def test_it_begins_when_more_has_gone_in_than_the_tip_got_on(loops: Loops) -> None:
    assert look(loops, [0.50, 0.42], [0.57, 0.51]) == ([False, True], [False, True])  # 9 and 11 cm in loops


def test_it_ends_when_three_quarters_are_straight(loops: Loops) -> None:
    look(loops, [0.42, 0.42], [0.51, 0.51])
    assert look(loops, [0.42, 0.43], [0.44, 0.43])[0] == [True, False]  # 4 and 2 cm in loops


def test_it_ends_when_the_tip_slips(loops: Loops) -> None:
    look(loops, [0.42, 0.42], [0.51, 0.51])
    assert look(loops, [0.39, 0.39], [0.47, 0.47])[0] == [False, True]
    assert look(loops, [0.36, 0.36], [0.44, 0.44])[0] == [False, False]


def test_it_ends_after_a_while_and_waits_for_progress(loops: Loops) -> None:
    for _ in range(LONGEST):
        assert look(loops, [0.42, 0.42], [0.55, 0.55])[0] == [True, True]
    assert look(loops, [0.44, 0.48], [0.60, 0.64]) == ([False, False], [False, False])
    assert look(loops, [0.44, 0.48], [0.60, 0.64]) == ([False, True], [False, True])  # 2 and 6 cm farther


def test_it_is_done_again_where_the_tip_does_not_get_on(loops: Loops) -> None:
    for _ in range(LONGEST):
        look(loops, [0.42, 0.42], [0.55, 0.55])
    for _ in range(AGAIN + 1):
        assert look(loops, [0.42, 0.42], [0.55, 0.45]) == ([False, False], [False, False])
    assert look(loops, [0.42, 0.42], [0.55, 0.45]) == ([True, False], [True, False])  # 15 and 5 cm in loops


def test_it_does_nothing_in_the_rectum() -> None:
    loops = Loops(1, "cpu", torch.full((1,), 0.1), torch.full((1,), 0.02))
    for inserted in (0.0, 0.2, 0.5):
        assert look(loops, [0.1], [inserted]) == ([False], [False])


def test_a_reset_forgets(loops: Loops) -> None:
    look(loops, [0.42, 0.42], [0.51, 0.51])
    loops.reset(torch.tensor([0]))
    assert look(loops, [0.42, 0.42], [0.51, 0.51]) == ([False, True], [False, False])
