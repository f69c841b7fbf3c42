# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A tip that gets on by 10 cm within a control step, or while it is behind the wall, went through the wall."""

from __future__ import annotations

import torch

from arcgym.start_states.leaps import Leaps


def test_a_leap_is_remembered_and_steps_are_none() -> None:
    leaps = Leaps(torch.tensor([0.30, 0.30]))
    everywhere = torch.tensor([True, True])
    assert leaps.update(torch.tensor([0.37, 0.30]), everywhere).tolist() == [False, False]
    assert leaps.update(torch.tensor([0.44, 0.40]), everywhere).tolist() == [False, True]
    assert leaps.update(torch.tensor([0.51, 0.41]), everywhere).tolist() == [False, True]


def test_a_way_behind_the_wall_counts_in_all() -> None:
    leaps = Leaps(torch.tensor([0.30, 0.30]))
    behind, inside = torch.tensor([False, False]), torch.tensor([True, True])
    for arc in (0.35, 0.40):
        assert leaps.update(torch.full((2,), arc), behind).tolist() == [False, False]
    assert leaps.update(torch.tensor([0.41, 0.36]), inside).tolist() == [True, False]


def test_who_takes_over_is_as_its_source() -> None:
    leaps = Leaps(torch.tensor([0.30, 0.50, 0.70]))
    leaps.update(torch.tensor([0.30, 0.60, 0.70]), torch.ones(3, dtype=torch.bool))
    leaps.take_over(torch.tensor([1]), torch.tensor([2]))
    assert leaps.update(torch.tensor([0.30, 0.71, 0.70]), torch.ones(3, dtype=torch.bool)).tolist() == [False] * 3
