# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Several things at the same time."""

from __future__ import annotations

import threading

import pytest

from arcgym.utils import cpu_threads as module
from arcgym.utils.cpu_threads import BETWEEN_TRIALS, FIRST_TRIALS, VARIABLE, Pace, cpu_threads, on_threads, share_out


@pytest.fixture
def two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr(module, "_cores", lambda: 2)


def test_all_threads_work_at_the_same_time() -> None:
    meeting, met = threading.Barrier(3, timeout=10.0), list[int]()

    def work(thread: int) -> None:
        meeting.wait()
        met.append(thread)

    on_threads(3, work)
    assert sorted(met) == [0, 1, 2]


def test_a_failure_in_another_thread_is_raised() -> None:
    meeting = threading.Barrier(2, timeout=10.0)

    def work(thread: int) -> None:
        meeting.wait()
        if thread == 1:
            raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        on_threads(2, work)


def test_every_part_is_done_once() -> None:
    done: list[int] = []
    share_out(3, range(100), done.append)
    assert sorted(done) == list(range(100))


@pytest.mark.parametrize(("value", "threads"), [("1", 1), ("2", 2), ("5", 5)])
def test_the_variable_says_how_many_threads(value: str, threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, value)
    assert cpu_threads() == Pace().threads() == threads


@pytest.mark.parametrize(("cores", "threads"), [(1, 1), (2, 2), (16, 2)])
def test_without_it_there_are_two_where_there_are_cores(
    cores: int, threads: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr(module, "_cores", lambda: cores)
    assert cpu_threads() == threads


@pytest.mark.parametrize("value", ["0", "two", "-1", "65", ""])
def test_another_value_is_refused(value: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, value)
    with pytest.raises(ValueError, match="from 1 to 64"):
        cpu_threads()


@pytest.mark.usefixtures("two_cores")
@pytest.mark.parametrize(("one", "two", "faster"), [(1.0, 0.6, 2), (1.0, 1.4, 1)])
def test_what_takes_less_time_is_chosen_and_the_other_tried_now_and_then(one: float, two: float, faster: int) -> None:
    pace, chosen = Pace(), []
    for _ in range(BETWEEN_TRIALS + 1):
        chosen.append(pace.threads())
        pace.note(chosen[-1], one if chosen[-1] == 1 else two)
    assert chosen[:FIRST_TRIALS] == [2, 1, 2, 1]
    assert chosen[FIRST_TRIALS:] == [faster] * (BETWEEN_TRIALS - FIRST_TRIALS) + [3 - faster]


@pytest.mark.usefixtures("two_cores")
def test_the_choice_changes_when_threads_become_slow() -> None:
    """Half of what was known counts on: 0.6, then (0.6 + 2) / 2 = 1.3, which is more than 1."""
    pace = Pace()
    for _ in range(FIRST_TRIALS):
        threads = pace.threads()
        pace.note(threads, 1.0 if threads == 1 else 0.6)
    assert pace.threads() == 2
    pace.note(2, 2.0)
    assert pace.threads() == 1
