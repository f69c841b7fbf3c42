# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Layout of a training run on disk: ``logs/rsl_rl/<experiment>/<time>[_<run name>]/``."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any

import yaml

from arcgym.utils.coerce import to_plain
from arcgym.utils.errors import UsageError
from arcgym.utils.files import write_whole

LOG_ROOT = Path("logs") / "rsl_rl"
"""Folder of the runs, below the one in which a command is called."""


def create_run_folder(experiment: str, run_name: str = "", root: Path = LOG_ROOT) -> Path:
    """Create and return the folder of a new run, named by the time of its start.

    A run that starts in the same second as another gets a number behind its name: no two runs share a folder.
    """
    stamp = datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
    name = f"{stamp}_{run_name}".rstrip("_")
    parent = (root / experiment).resolve()
    parent.mkdir(parents=True, exist_ok=True)
    number = 1
    while True:
        folder = parent / (name if number == 1 else f"{name}_{number}")
        try:
            folder.mkdir()
        except FileExistsError:
            number += 1
        else:
            return folder


def claim_folder(path: Path) -> Path:
    """Create and return the folder of a new run at a given place.

    Raises:
        UsageError: There is a file, or a folder that holds something.
    """
    folder = path.resolve()
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise UsageError(f"--log_dir is {path}, which holds something already; expected a new or empty folder.")
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@contextmanager
def removed_on_failure(folder: Path | None) -> Iterator[None]:
    """Remove a run's folder if the block fails or is interrupted: a run that never started leaves nothing."""
    try:
        yield
    except BaseException:
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)
        raise


def write_params(folder: Path, **values: Any) -> None:
    """Write each configuration, or dict of plain values, as ``params/<name>.yaml``, whole or not at all."""
    (folder / "params").mkdir(exist_ok=True)
    for name, value in values.items():
        text = yaml.safe_dump(to_plain(value), sort_keys=False)
        write_whole(folder / "params" / f"{name}.yaml", text.encode())


def find_checkpoint(experiment: str, load_run: str = ".*", checkpoint: str = "latest", root: Path = LOG_ROOT) -> Path:
    """Return the checkpoint that the arguments select.

    Args:
        experiment: Experiment whose runs are searched.
        load_run: Name of a run or a regular expression; among matches the newest run that has the checkpoint wins.
        checkpoint: ``latest``, ``best``, a file name such as ``model_100.pt``, or the path of a file, from here or from
            the folder of the experiment.
        root: Folder of all experiments.

    Raises:
        UsageError: Nothing matches, with what is there, or ``load_run`` is no regular expression.
    """
    if Path(checkpoint).is_file():
        return Path(checkpoint).resolve()
    if (root / experiment / checkpoint).is_file():
        return (root / experiment / checkpoint).resolve()
    if Path(checkpoint).name != checkpoint:
        raise UsageError(f"--checkpoint is '{checkpoint}': {_missing(Path(checkpoint))}.")
    try:
        pattern = re.compile(load_run)
    except re.error as error:
        raise UsageError(f"load_run '{load_run}' is no regular expression: {error}.") from error
    runs = sorted((path for path in (root / experiment).glob("*") if path.is_dir()), reverse=True)
    for run in runs:
        if run.name == load_run or pattern.fullmatch(run.name):
            found = _select(run, checkpoint)
            if found is not None:
                return found.resolve()
    available = [str(path.relative_to(root / experiment)) for run in runs for path in _checkpoints(run)]
    experiments = sorted(path.name for path in root.glob("*") if path.is_dir())
    elsewhere = "" if runs else f" Experiments in {root.resolve()}: {', '.join(experiments) or 'none'}."
    best = " A run has a best one once an episode has ended in it." if checkpoint == "best" and runs else ""
    raise UsageError(
        f"No checkpoint '{checkpoint}' of a run matching '{load_run}' in {(root / experiment).resolve()}. "
        f"Available: {', '.join(available) or 'none'}.{elsewhere}{best}"
    )


def has_checkpoints(experiment: str, root: Path = LOG_ROOT) -> bool:
    """Return whether a run of an experiment has a numbered checkpoint."""
    return any(_checkpoints(run) for run in (root / experiment).glob("*"))


def find_newest_checkpoint(run: Path) -> Path | None:
    """Return the numbered checkpoint of a run with the most iterations, or None where it has none."""
    numbered = _checkpoints(run)
    return numbered[-1] if numbered else None


def newest_checkpoint(run: Path) -> Path:
    """Return the newest numbered checkpoint in the folder of a run.

    Raises:
        UsageError: If there is none.
    """
    found = _checkpoints(run)
    if not found:
        raise UsageError(f"{run} has no checkpoint model_<number>.pt.")
    return found[-1]


def _missing(path: Path) -> str:
    """Return why a path is no file, and what its folder has instead."""
    if path.is_dir():
        folder, why = path, "that is a folder, expected a file"
    else:
        folder, why = path.parent, "there is no such file"
    found = sorted(each.name for each in folder.glob("*.pt"))
    return f"{why}; {folder} has {', '.join(found)}" if found else why


def _select(run: Path, checkpoint: str) -> Path | None:
    if checkpoint == "latest":
        return find_newest_checkpoint(run)
    path = run / ("model_best.pt" if checkpoint == "best" else checkpoint)
    return path if path.is_file() else None


def _checkpoints(run: Path) -> list[Path]:
    """Numbered checkpoints of a run, oldest iteration first."""
    numbers = {path: re.fullmatch(r"model_(\d+)\.pt", path.name) for path in run.glob("model_*.pt")}
    return sorted((path for path, match in numbers.items() if match), key=lambda path: int(path.stem.split("_")[1]))
