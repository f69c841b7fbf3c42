# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""When a tip backs off: after two control steps without 4 mm of progress, for one, then two, then two steps."""

from __future__ import annotations

import torch

from arcgym.experts.retreat import Retreat


def backs(retreat: Retreat, *arcs: float) -> list[bool]:
    return [bool(retreat.update(torch.tensor([arc]))[0]) for arc in arcs]


def test_it_backs_off_longer_at_every_attempt_up_to_the_longest() -> None:
    retreat = Retreat(1, "cpu", patience=2, first=1, longest=2)
    assert backs(retreat, *[0.1] * 4) == [False, False, False, True]
    assert backs(retreat, *[0.1] * 5) == [False, False, False, True, True]
    assert backs(retreat, *[0.1] * 6) == [False, False, False, True, True, False]


def test_progress_starts_it_anew() -> None:
    retreat = Retreat(1, "cpu", patience=2, first=1, longest=9)
    assert backs(retreat, 0.1, 0.1, 0.1, 0.105, 0.105, 0.105, 0.105) == [False] * 6 + [True]


def test_near_the_anus_nothing_backs_off() -> None:
    assert not any(backs(Retreat(1, "cpu", patience=1, first=3, longest=3), *[0.02] * 9))


def test_a_reset_forgets_one_world() -> None:
    retreat = Retreat(2, "cpu", patience=1, first=5, longest=5)
    for _ in range(3):
        backing, _ = retreat.update(torch.tensor([0.1, 0.1]))
    assert backing.tolist() == [True, True]
    retreat.reset(torch.tensor([0]))
    assert retreat.update(torch.tensor([0.1, 0.1]))[0].tolist() == [False, True]


def test_every_world_has_its_own_patience() -> None:
    retreat = Retreat(2, "cpu", patience=torch.tensor([1.0, 3.0]), first=1, longest=1)
    seen = [retreat.update(torch.tensor([0.1, 0.1]))[0].tolist() for _ in range(5)]
    assert seen == [[False, False], [False, False], [True, False], [False, False], [False, True]]
