# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Condition files: the trials of an evaluation, each with its patient and its seed. Loads neither torch nor Warp."""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Iterable
from dataclasses import dataclass, fields
from pathlib import Path

from arcgym.utils.errors import UsageError


@dataclass(frozen=True)
class Trial:
    """One episode that is to be run. Everything that is random in it follows from its seed."""

    trial: int
    """Number, unique in its file."""

    patient: str
    """Colon, as ``env.scene.colon.usd_path`` takes it."""

    seed: int
    """Seed of start, appearance, tissue and friction, 0 to 2^31 - 1."""

    group: int = 0
    """Trials of one group stand for one training seed in the statistics."""


COLUMNS = tuple(field.name for field in fields(Trial))
"""Columns of a condition file."""


@dataclass(frozen=True)
class Conditions:
    """The trials of one file."""

    name: str
    """Name of the file without its ending, such as ``paper_v1``."""

    trials: tuple[Trial, ...]
    """Trials in the order of the file."""

    sha256: str
    """Hash of the file's contents."""

    @property
    def groups(self) -> int:
        """Number of training seeds that the trials are for."""
        return len({trial.group for trial in self.trials})

    def checkpoint_number(self, trial: Trial, count: int) -> int:
        """Return which of several checkpoints runs a trial: that of its group, where each group has one.

        Of fewer checkpoints than groups each gets every ``count``-th trial of the file, so that all have as many.
        """
        return (trial.group if count == self.groups else self.trials.index(trial)) % count


def read_conditions(path: Path) -> Conditions:
    """Return the trials of a condition file.

    Raises:
        UsageError: The file is missing, has other columns, no trial, a number twice, or a value that does not fit.
    """
    if not path.is_file():
        known = sorted(file.stem for file in path.parent.glob("*.csv"))
        raise UsageError(f"There is no condition file {path}; in that folder are {', '.join(known) or 'none'}.")
    text = path.read_text()
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    if not rows:
        raise UsageError(f"{path} has no trial; expected lines with {', '.join(COLUMNS)}.")
    if tuple(rows[0]) != COLUMNS:
        raise UsageError(f"{path} has the columns {', '.join(map(str, rows[0]))}; expected {', '.join(COLUMNS)}.")
    trials = tuple(_read_trial(path, row) for row in rows)
    if len({trial.trial for trial in trials}) < len(trials):
        raise UsageError(f"{path} has a number of a trial twice; every trial needs one of its own.")
    return Conditions(path.stem, trials, hashlib.sha256(text.encode()).hexdigest())


def write_conditions(path: Path, trials: Iterable[Trial], comment: str) -> None:
    """Write a condition file.

    Args:
        path: File to write.
        trials: Its trials.
        comment: What the trials are for; every line of it becomes a comment.
    """
    out = io.StringIO()
    for line in comment.splitlines():
        out.write(f"# {line}\n")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([getattr(trial, name) for name in COLUMNS] for trial in trials)
    path.write_text(out.getvalue())


def _read_trial(path: Path, row: dict[str, str]) -> Trial:
    try:
        trial = Trial(int(row["trial"]), row["patient"], int(row["seed"]), int(row["group"]))
    except (TypeError, ValueError) as error:
        raise UsageError(f"{path}: {row} is no trial: {error}.") from error
    if not 0 <= trial.seed < 2**31:
        raise UsageError(f"{path}: trial {trial.trial} has the seed {trial.seed}; expected 0 to 2^31 - 1.")
    return trial
