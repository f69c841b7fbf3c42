# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two things at the same time."""

from __future__ import annotations

import threading

import pytest

from arcgym.utils.two_threads import VARIABLE, both, cpu_threads


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


@pytest.mark.parametrize(("value", "threads"), [(None, 1), ("1", 1), ("2", 2)])
def test_the_variable_says_how_many_threads(value: str | None, threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    if value is not None:
        monkeypatch.setenv(VARIABLE, value)
    assert cpu_threads() == threads


def test_another_number_of_threads_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "3")
    with pytest.raises(ValueError, match="expected 1 or 2"):
        cpu_threads()
