# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""One line that shows how far a drive is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from arcgym.start_states.drive import Drive
from arcgym.utils.progress import paused


def say(text: str) -> None:
    """Print a line on stderr, where it does not get between a command's figures."""
    Console(stderr=True, soft_wrap=True, highlight=False, markup=False).print(text)


@contextmanager
def shown(label: str, goal: float) -> Iterator[Callable[[Drive], Any]]:
    """Show a line that updates itself, and give what reports to it.

    Args:
        label: Text in front of the bar.
        goal: Arc length at which the drive is done [m].
    """
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[way]}"),
        TimeElapsedColumn(),
    )
    with paused(), Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        line = progress.add_task(label, total=goal, way="compiling")

        def report(drive: Drive) -> None:
            arc = min(route.arc for route in drive.routes)
            left = sum(route.running for route in drive.routes)
            way = f"{arc:.2f} of {goal:.2f} m, {drive.time:.0f} s simulated"
            way += f", {left} of {len(drive.routes)} patients left" if len(drive.routes) > 1 else ""
            progress.update(line, completed=min(arc, goal), way=way)

        yield report
