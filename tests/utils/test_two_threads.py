# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two things at the same time."""

from __future__ import annotations

import threading

import pytest
import torch

from arcgym.utils.two_threads import both, cpu_threads


def fail() -> None:
    raise ValueError("broken")


def test_each_may_wait_for_the_other() -> None:
    meeting = threading.Barrier(2, timeout=10.0)
    both(lambda: meeting.wait() and None, lambda: meeting.wait() and None)
    assert not meeting.broken


@pytest.mark.parametrize("first", [True, False])
def test_a_failure_of_either_is_raised_when_both_are_done(first: bool) -> None:
    done: list[int] = []
    work = (fail, lambda: done.append(1)) if first else (lambda: done.append(1), fail)
    with pytest.raises(ValueError, match="broken"):
        both(*work)
    assert done == [1]


def test_threads_are_those_of_torch_up_to_two() -> None:
    before = torch.get_num_threads()
    try:
        for threads in (1, 2, 3):
            torch.set_num_threads(threads)
            assert cpu_threads() == min(threads, 2)
    finally:
        torch.set_num_threads(before)
