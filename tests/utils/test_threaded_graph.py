# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Launches that several threads of a CPU share: each is done once a round, after what it needs."""

from __future__ import annotations

import pytest
import warp as wp

from arcgym.utils.threaded_graph import ThreadedGraph, at_the_same_time, in_parts, in_sequence, launch_rows


@wp.kernel
def double_and_add_row(first: int, values: wp.array[float]):
    i = first + wp.tid()
    values[i] = 2.0 * values[i] + float(i)


@wp.kernel
def sum_up_to(first: int, values: wp.array[float], sums: wp.array[float]):
    """From row ``first`` on, by a thread a row: not to be launched on several rows."""
    i = first + wp.tid()
    sums[i] = values[i] + wp.where(i > 0, sums[wp.max(i - 1, 0)], 0.0)


def sum_rows(first: int, rows: int, values: wp.array, sums: wp.array) -> None:
    for row in range(first, first + rows):
        wp.launch(sum_up_to, 1, inputs=[row, values, sums], device="cpu")


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_parts_of_one_stage_are_done_before_the_next(threads: int) -> None:
    """Each value doubles and gets its row added, twice a round: v -> 4 v + 3 row."""
    values = wp.ones(7, dtype=float, device="cpu")
    stages = ThreadedGraph(threads)

    def work() -> None:
        for _ in range(2):
            launch_rows(double_and_add_row, (7,), [values], [], "cpu")

    stages.record(work)
    assert values.numpy().tolist() == [1.0] * 7
    stages.run(3)
    stages.run()
    expected = [1.0] * 7
    for _ in range(4):
        expected = [4.0 * value + 3.0 * row for row, value in enumerate(expected)]
    assert values.numpy().tolist() == expected


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_what_follows_row_by_row_finds_the_rows_before_it(threads: int) -> None:
    """The sums of 1 + row, doubled each round before row is added: in round n the values are 2^n + (2^n - 1) row."""
    values, sums = wp.ones(9, dtype=float, device="cpu"), wp.zeros(9, dtype=float, device="cpu")
    stages = ThreadedGraph(threads)

    def produce(first: int, rows: int) -> None:
        wp.launch(double_and_add_row, rows, inputs=[first, values], device="cpu")

    stages.record(lambda: in_sequence(9, produce, lambda first, rows: sum_rows(first, rows, values, sums)))
    for rounds in (1, 2):
        stages.run()
        of_rows = [2.0**rounds + (2.0**rounds - 1.0) * row for row in range(9)]
        assert values.numpy().tolist() == of_rows
        assert sums.numpy().tolist() == [sum(of_rows[: row + 1]) for row in range(9)]


@pytest.mark.parametrize("threads", [1, 2])
def test_two_chains_are_both_done_before_what_follows(threads: int) -> None:
    one, other, both = (wp.ones(5, dtype=float, device="cpu") for _ in range(3))
    stages = ThreadedGraph(threads)

    def chain(values: wp.array, times: int) -> None:
        for _ in range(times):
            launch_rows(double_and_add_row, (5,), [values], [], "cpu")

    def work() -> None:
        at_the_same_time(lambda: chain(one, 1), lambda: chain(other, 3))
        wp.copy(both, one)
        wp.launch(sum_up_to, 1, inputs=[0, other, both], device="cpu")

    stages.record(work)
    stages.run(20)
    assert both.numpy()[0] == other.numpy()[0] == 2.0**60
    assert one.numpy()[0] == 2.0**20


def test_nothing_is_divided_outside_of_a_recording() -> None:
    calls: list[tuple[int, int]] = []
    in_parts(5, lambda *part: calls.append(part))
    in_sequence(3, lambda *part: calls.append(part), lambda *part: calls.append(part))
    assert calls == [(0, 5), (0, 3), (0, 3)]


def test_a_failure_while_recording_leaves_nothing_open() -> None:
    def fail(first: int, rows: int) -> None:
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        ThreadedGraph(2).record(lambda: in_parts(4, fail))
    with wp.ScopedCapture(device="cpu"):
        pass
    in_parts(1, lambda first, rows: None)
