# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Suites: which tasks are evaluated in which trials. Importing this loads neither torch nor Newton."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import yaml

FOLDER = Path(__file__).parents[2] / "arcgym_tasks" / "benchmark"
"""Folder with ``suites.yaml`` and the condition files, which are never changed: another version gets another name."""


@dataclass(frozen=True)
class Suite:
    """Tasks that are evaluated together."""

    segments: tuple[str, ...]
    """Tasks without their robot, segments or journeys: ``Sigmoid`` stands for ``ARC-Sigmoid-<robot>``."""

    conditions: str
    """Condition file of each of them, without its ending."""

    overrides: tuple[str, ...] = ()
    """Overrides of the environment's configuration, as on the command line."""

    variants: tuple[str, ...] = ()
    """Values of ``env.robustness`` that each task is evaluated with; none for the tasks as they are."""

    def tasks(self, robot: str) -> list[str]:
        """Return the tasks for a robot, such as ``Magnetic``: registered names, with ``:variant`` where there are."""
        names = [f"ARC-{segment}-{robot}" for segment in self.segments]
        return [f"{name}:{variant}" for name in names for variant in self.variants] if self.variants else names

    @property
    def conditions_path(self) -> Path:
        """Path of the condition file."""
        return FOLDER / "conditions" / f"{self.conditions}.csv"


def split_task(task: str) -> tuple[str, str | None]:
    """Return registered name and variant of a task, such as ``ARC-Sigmoid-Magnetic:blur_2``; no variant is None."""
    name, _, variant = task.partition(":")
    return name, variant or None


def task_overrides(task: str) -> tuple[str, ...]:
    """Return the overrides that a task's variant stands for."""
    _, variant = split_task(task)
    return (f"env.robustness={variant}",) if variant else ()


def read_suites(path: Path = FOLDER / "suites.yaml") -> dict[str, Suite]:
    """Return the suites of a file by name."""
    return {name: _suite(values) for name, values in yaml.safe_load(path.read_text()).items()}


def _suite(values: dict[str, object]) -> Suite:
    return Suite(**{name: tuple(value) if isinstance(value, list) else value for name, value in values.items()})  # type: ignore[arg-type]
