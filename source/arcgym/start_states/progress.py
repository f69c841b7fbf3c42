# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""One line that shows how far a drive is."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from arcgym.start_states.drive import Drive
from arcgym.utils.progress import LINE_PERIOD_S, paused


def say(text: str) -> None:
    """Print a line on stderr, where it does not get between a command's figures."""
    Console(stderr=True, soft_wrap=True, highlight=False, markup=False).print(text)


@contextmanager
def shown(label: str, goal: float) -> Iterator[Callable[[Drive], Any]]:
    """Show a line that updates itself, elsewhere than on a terminal a line every ten seconds; give what reports to it.

    Args:
        label: Text in front of the bar.
        goal: Arc length at which the drive is done [m].
    """
    if not sys.stderr.isatty():
        yield _printer(label, goal)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[way]}"),
        TimeElapsedColumn(),
    )
    with paused(), Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        line = progress.add_task(label, total=goal, way="compiling")

        def report(drive: Drive) -> None:
            progress.update(line, completed=min(_arc(drive), goal), way=_way(drive, goal))

        yield report


def _printer(label: str, goal: float) -> Callable[[Drive], Any]:
    """Return a function that says how far a drive is when it last did so ten seconds ago."""
    printed = time.perf_counter()

    def report(drive: Drive) -> None:
        nonlocal printed
        if time.perf_counter() - printed > LINE_PERIOD_S:
            printed = time.perf_counter()
            say(f"{label}: {_way(drive, goal)}")

    return report


def _arc(drive: Drive) -> float:
    """Return how far the patient is that is behind all others [m]."""
    return min(route.arc for route in drive.routes)


def _way(drive: Drive, goal: float) -> str:
    """Return in words how far a drive is."""
    left = sum(route.running for route in drive.routes)
    way = f"{_arc(drive):.2f} of {goal:.2f} m, {drive.time:.0f} s simulated"
    return way + (f", {left} of {len(drive.routes)} patients left" if len(drive.routes) > 1 else "")
