# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a soak has found, task by task. Importing this loads neither torch nor Warp."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from arcgym.benchmarks.soak.journal import Journal


def findings(tasks: Sequence[str], journal: Journal, growth_mib: float) -> list[dict[str, Any]]:
    """Return a row for each task: its tally, its events and its violations.

    Args:
        tasks: Names of the tasks.
        journal: The file of findings.
        growth_mib: Largest growth of memory that is tolerated [MiB].
    """
    rows = []
    for task in tasks:
        tally = journal.tally(task)
        violations = tally.violations(growth_mib)
        if tally.env_steps == 0:
            violations.append("no step was made")
        rows.append({"task": task, **asdict(tally), "events": journal.events(task), "violations": violations})
    return rows
