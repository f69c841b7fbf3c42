# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Launches recorded as stages that several threads of a CPU replay together, to the bits of one thread."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import warp as wp
from warp._src import context

from arcgym.utils import threaded_graph_kernels, warp_setup  # noqa: F401
from arcgym.utils.cpu_threads import on_threads
from arcgym.utils.warp_setup import GPU_BLOCK

PARTS = 2
"""Tasks that a launch of independent rows is divided into, for each thread."""
LINE = 8
"""Numbers of a cache line."""

Rows = Callable[[int, int], None]
"""Launches kernels on some rows, given the first one and how many."""


@dataclass
class TaskGroup:
    """Tasks that may be done in any order and at the same time."""

    graphs: list[wp.Graph]
    needs: list[int]
    """Stages to be done before."""


@dataclass
class ThreadedGraph:
    """Recorded work. Launches outside :func:`in_parts` are done one after the other, each stage after the one before.

    What :func:`at_the_same_time` was given is two chains of stages that do not wait for each other.
    """

    threads: int
    _stages: list[TaskGroup] = field(default_factory=list)
    _ends: list[int] = field(default_factory=list)
    """Stages that the next one has to wait for."""
    _rounds: int = 0

    def record(self, work: Callable[[], None]) -> None:
        """Record what ``work`` launches on the CPU; nothing is done."""
        _recording.append(self)
        try:
            wp.capture_begin("cpu")
            work()
            self._add([wp.capture_end("cpu")])
        finally:
            _recording.pop()
            if wp.get_device("cpu").is_capturing:
                wp.capture_end("cpu")
        self._pack()

    def run(self, times: int = 1, threads: int | None = None) -> None:
        """Do all that was recorded, as many times as said, on some threads or as many as it was recorded for.

        Raises:
            RuntimeError: If a graph could not be replayed.
        """
        threads = threads or self.threads

        def share(thread: int) -> None:
            inputs = [self._calls, self._plan, self._graphs, thread, threads, self._rounds, times]
            outputs = [self._taken, self._progress]
            wp.launch(threaded_graph_kernels.share, 1, inputs=inputs, outputs=outputs, device="cpu")

        on_threads(threads, share)
        self._rounds += times
        if self._counters[-1, 0]:
            raise RuntimeError("Warp could not replay a part of a physics step on the CPU; see its message above.")

    def split(self, rows: int, launch: Rows) -> None:
        """End the present stage, and record one of the ``rows`` in parts."""
        self._add([wp.capture_end("cpu")])
        self._add([_recorded(launch, part) for part in self._parts(rows)])
        wp.capture_begin("cpu")

    def follow(self, rows: int, launch: Rows, then: Rows) -> None:
        """End the present stage, and record ``launch`` on parts of the ``rows``, ``then`` on them in their order."""
        self._add([wp.capture_end("cpu")])
        begin, before = self._ends, list[int]()
        for part in self._parts(rows):
            self._ends = begin
            self._add([_recorded(launch, part)])
            self._ends += before
            self._add([_recorded(then, part)])
            before = self._ends
        wp.capture_begin("cpu")

    def _parts(self, rows: int) -> list[tuple[int, int]]:
        """Return first row and number of rows of each part."""
        parts = min(rows, PARTS * self.threads)
        bounds = [rows * k // parts for k in range(parts + 1)]
        return [(first, end - first) for first, end in zip(bounds[:-1], bounds[1:], strict=True)]

    def fork(self, one: Callable[[], None], other: Callable[[], None]) -> None:
        """Record two chains."""
        self._add([wp.capture_end("cpu")])
        begin, ends = self._ends, []
        for work in (one, other):
            self._ends = begin
            wp.capture_begin("cpu")
            work()
            self._add([wp.capture_end("cpu")])
            ends += self._ends
        self._ends = ends
        wp.capture_begin("cpu")

    def _add(self, graphs: list[wp.Graph]) -> None:
        if not any(_operations(graph) for graph in graphs):
            return
        self._stages.append(TaskGroup(graphs, self._ends))
        self._ends = [len(self._stages) - 1]

    def _pack(self) -> None:
        sizes = [len(stage.graphs) for stage in self._stages]
        firsts = np.cumsum([0, *sizes])[:-1]
        plan = [
            [first, size, *(stage.needs + [-1, -1])[:2]]
            for first, size, stage in zip(firsts, sizes, self._stages, strict=True)
        ]
        states = [graph.apic_state for stage in self._stages for graph in stage.graphs]
        self._plan = wp.array(np.array(plan, np.int64), dtype=wp.int64, device="cpu")
        self._graphs = wp.array(np.array(states, np.int64), dtype=wp.int64, device="cpu")
        self._calls = wp.array(np.array([_replay(), _rest()], np.int64), dtype=wp.int64, device="cpu")
        self._taken = wp.zeros(len(states), dtype=wp.int64, device="cpu")
        self._progress = wp.zeros((len(self._stages) + 1, LINE), dtype=wp.int64, device="cpu")
        self._counters = self._progress.numpy()
        wp.load_module(threaded_graph_kernels, device="cpu")


_recording: list[ThreadedGraph] = []


def _operations(graph: wp.Graph) -> int:
    return int(context.runtime.core.wp_apic_get_operation_count(graph.apic_state))


def _recorded(launch: Rows, part: tuple[int, int]) -> wp.Graph:
    wp.capture_begin("cpu")
    launch(*part)
    return wp.capture_end("cpu")


def in_parts(rows: int, launch: Rows) -> None:
    """Launch kernels on ``rows`` that do not need each other: at once, or while stages are recorded in parts."""
    if _recording and rows > 1:
        _recording[-1].split(rows, launch)
    else:
        launch(0, rows)


def in_sequence(rows: int, launch: Rows, then: Rows) -> None:
    """Launch kernels on ``rows`` that do not need each other, ``then`` others on the same rows from first to last.

    While stages are recorded in parts, of which ``then`` needs only its own and those before.
    """
    if _recording and rows > 1:
        _recording[-1].follow(rows, launch, then)
    else:
        launch(0, rows)
        then(0, rows)


def launch_rows(
    kernel: wp.Kernel,
    shape: tuple[int, ...],
    inputs: list[Any],
    outputs: list[Any],
    device: str,
    block_dim: int = GPU_BLOCK,
) -> None:
    """Launch a kernel whose first argument is the first row of a launch, :func:`in_parts`."""

    def launch(first: int, rows: int) -> None:
        dim = (rows, *shape[1:])
        wp.launch(kernel, dim, inputs=[first, *inputs], outputs=outputs, device=device, block_dim=block_dim)

    in_parts(shape[0], launch)


def at_the_same_time(one: Callable[[], None], other: Callable[[], None]) -> None:
    """Do ``one``, then ``other``, neither of which may need the other; while stages are recorded, as two chains."""
    if _recording:
        _recording[-1].fork(one, other)
    else:
        one()
        other()


def _replay() -> int:
    """Return the address of Warp's function that replays a graph of the CPU."""
    return ctypes.cast(context.runtime.core.wp_apic_cpu_replay_state, ctypes.c_void_p).value or 0


def _rest() -> int:
    """Return the address of the C library's function that gives up the core; 0 where there is none."""
    try:
        return ctypes.cast(ctypes.CDLL(None).sched_yield, ctypes.c_void_p).value or 0
    except (AttributeError, OSError, TypeError):
        return 0
