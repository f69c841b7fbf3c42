# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Suites: which tasks are evaluated in which trials. Importing this loads neither torch nor Newton."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from arcgym.evaluation.trials import Conditions, read_conditions
from arcgym.utils.errors import UsageError

FOLDER = Path(__file__).parents[2] / "arcgym_tasks" / "benchmark"
"""Folder with ``suites.yaml`` and the condition files, which are never changed: another version gets another name."""


@dataclass(frozen=True)
class Suite:
    """Tasks that are evaluated together."""

    segments: tuple[str, ...]
    """Tasks without their robot, segments or journeys: ``Sigmoid`` stands for ``ARC-Sigmoid-<robot>``."""

    conditions: str
    """Condition file of each of them, without its ending."""

    earlier: tuple[str, ...] = ()
    """Condition files that were the suite's before, newest first: results of their trials are shown as such."""

    overrides: tuple[str, ...] = ()
    """Overrides of the environment's configuration, as on the command line."""

    variants: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """Overrides of the variants that each task is evaluated in, by name; none for the tasks as they are. In the file a
    plain list of names stands for values of ``env.robustness``."""

    def tasks(self, robot: str) -> list[str]:
        """Return the tasks for a robot, such as ``Magnetic``: registered names, with ``:variant`` where there are."""
        names = [f"ARC-{segment}-{robot}" for segment in self.segments]
        return [f"{name}:{variant}" for name in names for variant in self.variants] if self.variants else names

    def overrides_of(self, task: str) -> tuple[str, ...]:
        """Return the overrides of a task: the suite's, and those of its variant."""
        _, variant = split_task(task)
        if variant is None or variant in self.variants:
            return (*self.overrides, *self.variants.get(variant or "", ()))
        return (*self.overrides, f"env.robustness={variant}")

    @property
    def conditions_path(self) -> Path:
        """Path of the condition file."""
        return FOLDER / "conditions" / f"{self.conditions}.csv"

    def conditions_of(self, sha256: str | None) -> Conditions:
        """Return the condition file with a hash, of the suite's and those before; the suite's if none has it."""
        files = [read_conditions(self.conditions_path.with_stem(name)) for name in (self.conditions, *self.earlier)]
        return next((file for file in files if file.sha256 == sha256), files[0])


def split_task(task: str) -> tuple[str, str | None]:
    """Return registered name and variant of a task, such as ``ARC-Sigmoid-Magnetic:blur_2``; no variant is None."""
    name, _, variant = task.partition(":")
    return name, variant or None


@functools.cache
def read_suites(path: Path = FOLDER / "suites.yaml") -> Mapping[str, Suite]:
    """Return the suites of a file by name; each file is read once."""
    return {name: _suite(values) for name, values in yaml.safe_load(path.read_text()).items()}


def refuse_earlier(conditions: Conditions) -> None:
    """Refuse trials of an earlier version of the population.

    Raises:
        UsageError: Their patients cannot be made any more; names the file of the present ones.
    """
    for suite in read_suites().values():
        if suite.conditions_of(conditions.sha256).name in suite.earlier:
            raise UsageError(
                f"{conditions.name} is of an earlier version of the population, whose patients cannot be made any more;"
                f" the same trials on the present ones are {suite.conditions}."
            )


def _suite(values: dict[str, Any]) -> Suite:
    variants = values.get("variants") or {}
    if isinstance(variants, list):
        variants = {name: [f"env.robustness={name}"] for name in variants}
    return Suite(
        segments=tuple(values["segments"]),
        conditions=values["conditions"],
        earlier=tuple(values.get("earlier", ())),
        overrides=tuple(values.get("overrides", ())),
        variants={name: tuple(texts) for name, texts in variants.items()},
    )
