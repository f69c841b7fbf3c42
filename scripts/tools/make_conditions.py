# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Write condition files of the benchmark that are not there yet; a file that is there is never changed.

python scripts/tools/make_conditions.py
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

from arcgym.anatomy.generator.splits import read_splits
from arcgym.evaluation.suites import FOLDER
from arcgym.evaluation.trials import Trial, write_conditions

GROUPS = 5
"""Training seeds that the trials on many patients are shared by."""

SEEDS_OF = {
    "population_v4": "population_v2",
    "robustness_v4": "robustness_v2",
    "withdrawal_population_v3": "withdrawal_population_v1",
}
"""Earlier file whose seeds a file has: the same trials on the patients of another version."""


def seed_of(name: str, trial: int) -> int:
    """Return the seed of a trial: the first 31 bits of a hash of its name."""
    return int.from_bytes(hashlib.sha256(f"{name}/{trial}".encode()).digest()[:4], "big") >> 1


def trials_of(name: str, patients: Iterable[str], each: int) -> list[Trial]:
    """Return so many trials on each patient, one after another."""
    names = [patient for patient in patients for _ in range(each)]
    return [Trial(trial, patient, seed_of(name, trial), trial % GROUPS) for trial, patient in enumerate(names)]


def main() -> None:
    """Write the files."""
    splits = read_splits()
    unseen = [f"population:{seed}" for seed in splits.seeds["test"]]
    version = f"(splits {splits.version}, generator {splits.generator})"
    files = {
        "population_v4": (unseen, 1, f"A trial on each of the 200 patients of the test split {version}."),
        "ct_v1": ([f"ct_{number}/colon.usda" for number in (1, 2)], 10, "Ten trials on each of the two CT patients."),
        "cross_colon_v1": (
            [f"colon_{number}/colon.usda" for number in (3, 4, 5)],
            10,
            "Ten trials on each of the colons 3, 4 and 5, for policies that were trained on 1 and 2.",
        ),
        "robustness_v4": (
            unseen[:10],
            2,
            f"Two trials on each of ten patients of the test split {version}, for each variant.",
        ),
        "withdrawal_population_v3": (
            unseen[:20],
            1,
            f"A trial on each of the first 20 patients of the test split {version}: from the cecum back.",
        ),
    }
    for name, (patients, each, comment) in files.items():
        path: Path = FOLDER / "conditions" / f"{name}.csv"
        if not path.exists():
            base = SEEDS_OF.get(name, name)
            seeds = f"Seeds: the first 31 bits of SHA-256 of '{base}/<trial>'."
            write_conditions(path, trials_of(base, patients, each), f"{comment}\n{seeds}")
            print(path)


if __name__ == "__main__":
    main()
