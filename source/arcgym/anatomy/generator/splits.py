# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Splits of the random patients by seed, as ``splits.yaml`` beside this file has them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import yaml

from arcgym.utils.string import did_you_mean

PATIENT = re.compile(r"\d+(\*\d*\.?\d+)?")
"""Form of the name of a single patient."""
SPLITS_FILE = Path(__file__).with_name("splits.yaml")
"""The file that defines the splits."""


@dataclass(frozen=True)
class Splits:
    """Seeds of the random patients."""

    version: int
    """Version of the splits; belongs to every result."""
    generator: int
    """Version of the generator that makes their patients."""
    grid: tuple[int, int]
    """Rings and sectors of their walls."""
    seeds: dict[str, range]
    """Seeds of each split by name."""


@cache
def read_splits() -> Splits:
    """Return the splits."""
    values = yaml.safe_load(SPLITS_FILE.read_text())
    seeds = {name: range(first, last + 1) for name, (first, last) in values["splits"].items()}
    rings, sectors = values["grid"]
    return Splits(int(values["version"]), int(values["generator"]), (int(rings), int(sectors)), seeds)


def split_seeds(name: str) -> range:
    """Return the seeds of a split.

    Raises:
        ValueError: There is no such split; lists those there are.
    """
    seeds = read_splits().seeds
    if name not in seeds:
        raise ValueError(f"Unknown split '{name}' of the population. {did_you_mean(name, seeds)}")
    return seeds[name]


def given_patients(text: str) -> list[str] | None:
    """Return single patients that commas separate, such as ``20000,20001*0.8``; None if the text names none by seed.

    A factor after the seed is one on the width of the lumen: the patient with less gas.

    Raises:
        ValueError: If a seed is in no split; names the splits.
    """
    names = text.split(",")
    if not all(PATIENT.fullmatch(name) for name in names):
        return None
    known = read_splits().seeds
    for name in names:
        seed = int(name.partition("*")[0])
        if not any(seed in split for split in known.values()):
            ranges = ", ".join(f"{name} {split[0]} to {split[-1]}" for name, split in known.items())
            raise ValueError(f"Seed {seed} is in no split of the population; there are {ranges}.")
    return names
