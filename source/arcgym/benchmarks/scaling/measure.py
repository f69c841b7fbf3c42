# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Trains with one and more processes and reads how fast it went."""

from __future__ import annotations

import statistics
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

WARM_UP = 3
"""Iterations at the start that do not count: kernels are compiled and graphs captured in them."""

RATES = {"steps/s": "Perf/total_fps", "collect s": "Perf/collection_time", "learn s": "Perf/learning_time"}
"""Name of each figure, and its tag in the log."""


@dataclass(frozen=True)
class Settings:
    """What is trained."""

    task: str
    """Registered name."""

    agent: str
    """Agent, such as ``ppo``."""

    device: str
    """``cuda`` for one GPU a process, or ``cpu``."""

    num_envs: int
    """Worlds of each process."""

    iterations: int
    """Updates, with :data:`WARM_UP` at the start that do not count."""

    overrides: Sequence[str] = ()
    """Overrides ``env.…=…`` and ``agent.…=…``."""


def command(settings: Settings, processes: int, folder: Path) -> list[str]:
    """Return the command that trains with so many processes into a folder."""
    words = ["train", "--task", settings.task, "--agent", settings.agent, "--num_envs", str(settings.num_envs)]
    words += ["--max_iterations", str(settings.iterations), "--device", settings.device, "--log_dir", str(folder)]
    if processes == 1:
        return [sys.executable, "-m", "arcgym", *words, *settings.overrides]
    launcher = ["-m", "torch.distributed.run", "--standalone", "--nproc_per_node", str(processes)]
    return [sys.executable, *launcher, "-m", "arcgym", *words, "--distributed", *settings.overrides]


def measure(settings: Settings, processes: int, folder: Path) -> dict[str, Any]:
    """Train and return the medians of :data:`RATES` after the warm-up, or ``error`` with the end of the output.

    Args:
        settings: What is trained.
        processes: Processes, and GPUs unless the device is the CPU.
        folder: Folder of the run, not there yet.
    """
    row: dict[str, Any] = {"processes": processes, "num_envs": processes * settings.num_envs}
    result = subprocess.run(command(settings, processes, folder), capture_output=True, text=True)
    if result.returncode != 0:
        return row | {"error": " ".join(f"{result.stdout[-400:]} {result.stderr[-800:]}".split())}
    return row | read_rates(folder)


def read_rates(folder: Path) -> dict[str, float]:
    """Return the medians of :data:`RATES` in a run's log after the warm-up."""
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    log = EventAccumulator(str(folder))
    log.Reload()
    values = {name: [event.value for event in log.Scalars(tag)][WARM_UP:] for name, tag in RATES.items()}
    return {name: round(statistics.median(numbers), 3) for name, numbers in values.items()}


def add_factors(rows: list[dict[str, Any]]) -> None:
    """Give each row ``factor``, its steps a second over those of the first row, in place."""
    for row in rows:
        if "steps/s" in row and "steps/s" in rows[0]:
            row["factor"] = round(row["steps/s"] / rows[0]["steps/s"], 3)
