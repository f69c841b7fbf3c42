# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Settings of a throughput measurement. Importing this loads neither torch nor Warp."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Row = dict[str, Any]
"""Figures of one number of worlds, or ``num_envs`` and ``error``."""


@dataclass(frozen=True)
class Settings:
    """What is measured, for every number of worlds alike."""

    task: str
    """Registered name of the task."""
    device: str
    """Device of the simulation."""
    steps: int = 20
    """Timed control steps; the median counts."""
    repeats: int = 7
    """Timed calls of each stage."""
    seed: int = 0
    """Seed of environment and actions."""
    start: str = "end"
    """Where in the segment the tip is when timing begins: ``end`` or ``entry``."""
    stages: bool = False
    """Whether to time each part of a control step alone, too."""
    bandwidth: bool = False
    """Whether to estimate the memory traffic beside a measured copy's."""
    patients: int = 0
    """Patients in the batch; 0 for those of the configuration. Where it has one colon, the others stand in for a
    population: see :mod:`arcgym.benchmarks.throughput.stand_ins`."""
    timeout: float = 1800.0
    """Longest run of one number of worlds [s]."""
