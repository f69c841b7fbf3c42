# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""When a scope is pulled back with a hooked tip: two worlds, 10 N, tips that may slip by 4 cm, pulls of 10 cm."""

from __future__ import annotations

import pytest
import torch

from arcgym.experts.pull_back import LONGEST, PRESSED, REST, PullBack


@pytest.fixture
def pulls() -> PullBack:
    """Both worlds have gone on for long enough, with their tips at 0.5 m."""
    pulls = PullBack(torch.full((2,), 10.0), torch.full((2,), 0.04), torch.full((2,), 0.1))
    for _ in range(REST):
        look(pulls)
    return pulls


def look(
    pulls: PullBack,
    arc: tuple[float, float] = (0.5, 0.5),
    inserted: tuple[float, float] = (0.6, 0.6),
    push: tuple[float, float] = (0.0, 0.0),
    asked: tuple[bool, bool] = (False, False),
) -> tuple[list[bool], list[bool]]:
    """Return which worlds are pulled, and which begin to be."""
    on, begins = pulls.update(torch.tensor(arc), torch.tensor(inserted), torch.tensor(push), torch.tensor(asked))
    return on.tolist(), begins.tolist()


def test_it_begins_after_half_a_second_of_a_push_that_is_too_hard(pulls: PullBack) -> None:
    for _ in range(PRESSED - 1):
        assert look(pulls, push=(11.0, 9.0)) == ([False, False], [False, False])
    assert look(pulls, push=(11.0, 9.0)) == ([True, False], [True, False])
    assert look(pulls) == ([True, False], [False, False])


def test_it_begins_where_it_is_asked_for_but_not_in_the_rectum(pulls: PullBack) -> None:
    assert look(pulls, arc=(0.5, 0.1), asked=(True, True))[1] == [True, False]


def test_it_ends_when_the_tip_slips_or_the_shaft_is_out(pulls: PullBack) -> None:
    look(pulls, asked=(True, True))
    assert look(pulls, arc=(0.47, 0.45), inserted=(0.55, 0.55))[0] == [True, False]
    assert look(pulls, arc=(0.47, 0.45), inserted=(0.49, 0.55))[0] == [False, False]


def test_it_ends_when_it_takes_as_much_force_as_a_push_may(pulls: PullBack) -> None:
    look(pulls, asked=(True, True))
    assert look(pulls, push=(-11.0, -9.0))[0] == [False, True]


def test_after_a_pull_it_goes_on_for_a_while(pulls: PullBack) -> None:
    look(pulls, asked=(True, True))
    assert look(pulls, inserted=(0.4, 0.4))[0] == [False, False]
    for _ in range(REST):
        assert look(pulls, push=(11.0, 0.0))[0] == [False, False]
    assert look(pulls, push=(11.0, 0.0))[0] == [True, False]


def test_it_is_asked_for_again_once_what_was_pulled_out_is_in(pulls: PullBack) -> None:
    look(pulls, asked=(True, True))
    look(pulls, inserted=(0.4, 0.4))
    assert look(pulls, inserted=(0.61, 0.55), asked=(True, True))[1] == [True, False]
    for _ in range(LONGEST):
        look(pulls, inserted=(0.4, 0.55))
    assert look(pulls, inserted=(0.4, 0.55), asked=(False, True))[1] == [False, True]
