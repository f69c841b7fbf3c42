# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Folder of an evaluation: what was run in ``run.json``, a row a trial in ``trials.csv``.

Importing this loads neither torch nor Warp.
"""

from __future__ import annotations

import csv
import gzip
import json
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

from arcgym.evaluation.run_shape import fault
from arcgym.evaluation.task_settings import TaskSetting
from arcgym.utils.errors import UsageError

TRIALS_FILE = "trials.csv"
"""A row a trial; rows are added as trials end."""
PACKED_FILE = f"{TRIALS_FILE}.gz"
"""The same rows, packed, in small copies of result folders."""
RUN_FILE = "run.json"
"""Agent, checkpoint, suite, conditions, versions."""
SUMMARY_FILE = "summary.md"
"""Tables of all trials, written when they have ended."""
PARTS = "parts"
"""Folder of the shares of several processes, in that of all rows."""
IDENTITY = ("agent", "checkpoint_sha256", "suite", "conditions_sha256", "overrides")
"""Entries of the run that must agree for rows to belong together."""

ANY_VERSION = ("python",)
"""Versions that may differ between rows that belong together; all others must agree."""

TEXTS = ("task", "agent", "patient", "end")
"""Columns that are texts, whatever they look like: a hash may be made of digits."""

HASH = 12
"""Digits of a checkpoint's hash that stand for it in the rows of small copies."""

UNKNOWN = "unknown:"
"""How an entry of ``trained_on`` begins whose patients are not known."""

DROPPED = "dropped_contacts"
"""Entry of ``run.json``: contacts that found no room by task, where there were any."""

COMMIT, CHANGED, CODE = "arcgym commit", " with changes", "arcgym code"
"""Name of ARCGym's commit among the versions, its ending where the code was not that of the commit, and the name of the
hash of the code of an installation, which has no commit."""

Row = dict[str, Any]
"""One trial's results by column."""


class ResultFolder:
    """Rows of one evaluation, written as they come; a run that was cut off goes on where it stopped."""

    def __init__(self, path: Path, run: dict[str, Any]) -> None:
        """Make the folder, or open that of the same evaluation.

        Args:
            path: The folder.
            run: What is run; the entries in :data:`IDENTITY`, the versions and the machine must be those of the folder.

        Raises:
            UsageError: The folder holds another evaluation, or one by other code or on another kind of device.
        """
        self.path = path
        path.mkdir(parents=True, exist_ok=True)
        file = path / RUN_FILE
        if file.is_file():
            _check_same(file, json.loads(file.read_text()), run)
        else:
            _write_run(file, run)
        self.names = _names(run, read_run(path))
        """Checkpoint that rows name, by the path that it was given with: of the same file the one in ``run.json``."""
        _cut_torn_line(path / TRIALS_FILE)
        self.rows = read_trial_rows(path)
        """Rows so far."""
        if not self.rows:  # a head alone: the first row brings its own
            (path / TRIALS_FILE).unlink(missing_ok=True)

    def clear(self) -> None:
        """Take what says how it was run away; for a folder without rows."""
        (self.path / RUN_FILE).unlink(missing_ok=True)
        if not any(self.path.iterdir()):
            self.path.rmdir()

    def done(self, task: str) -> set[int]:
        """Return the numbers of the trials of a task that have a row."""
        return {row["trial"] for row in self.rows if row["task"] == task}

    def note_changes(self, task: str, changes: dict[str, list[Any]]) -> None:
        """Write down which fields of a task are not as registered: registered and used value by path."""
        self._note("changes", task, changes)

    def note_setting(self, setting: TaskSetting, task: str, value: float | None) -> None:
        """Write down the value that a setting of a task had; None is not written."""
        if value is not None:
            self._note(setting.entry, task, value)

    def note_dropped(self, task: str, contacts: int) -> None:
        """Write down how many contacts of a task found no room, which makes its forces wrong; 0 is not written."""
        run = read_run(self.path)
        if contacts > 0:
            run.setdefault(DROPPED, {})[task] = contacts
            _write_run(self.path / RUN_FILE, run)

    def dropped(self, task: str) -> int:
        """Return how many contacts of a task found no room so far."""
        return read_run(self.path).get(DROPPED, {}).get(task, 0)

    def note_inputs(self, task: str, inputs: dict[str, Any]) -> None:
        """Write down what a trained agent sees in a task, see :func:`arcgym.evaluation.agents.inputs_of`."""
        self._note("inputs", task, inputs)

    def _note(self, entry: str, task: str, value: Any) -> None:
        """Write down how a task is run.

        Raises:
            UsageError: If trials of the task were run otherwise.
        """
        run = read_run(self.path)
        before = run.get(entry, {}).get(task)
        if task in run.get(entry, {}) and before != value and self.done(task):
            raise UsageError(
                f"{self.path} has trials of {task} that were run otherwise: '{entry}' was {before} and is {value}. "
                "Choose another folder, or bring the parameters beside the checkpoint back."
            )
        run.setdefault(entry, {})[task] = value
        _write_run(self.path / RUN_FILE, run)

    def add(self, row: Row) -> None:
        """Write a row to the disk.

        Raises:
            ValueError: If it has other columns than the rows before.
        """
        file = self.path / TRIALS_FILE
        if self.rows and list(row) != list(self.rows[0]):
            extra = sorted(set(row) ^ set(self.rows[0]))
            raise ValueError(f"A row of {file} has other columns than those before: {', '.join(extra) or 'order'}.")
        with file.open("a", newline="") as out:
            writer = csv.DictWriter(out, list(row), lineterminator="\n")
            if not self.rows:
                writer.writeheader()
            writer.writerow(row)
            out.flush()
            os.fsync(out.fileno())
        self.rows.append(row)


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Make a folder and hold it while the block writes to it; what a process held that was killed is free.

    Raises:
        UsageError: Another process holds it. Where folders cannot be locked, nobody does.
    """
    folder.mkdir(parents=True, exist_ok=True)
    handle = os.open(folder, os.O_RDONLY) if fcntl else None
    try:
        if fcntl and handle is not None:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise UsageError(
                    f"Another evaluation writes to {folder}: wait for it, or give another --out. Shares have folders "
                    "of their own, which arcgym results merge puts together."
                ) from error
            except OSError:
                pass
        yield
    finally:
        if handle is not None:
            os.close(handle)


def result_folders(folder: Path) -> list[Path]:
    """Return the result folders in a folder, itself included, in order; those of processes are parts of theirs.

    Raises:
        UsageError: There is no such folder.
    """
    if not folder.is_dir():
        raise UsageError(f"There is no folder {folder}; expected one with result folders in it.")
    return sorted(file.parent for file in folder.rglob(RUN_FILE) if file.parent.parent.name != PARTS)


def read_trial_rows(path: Path) -> list[Row]:
    """Return the rows of a result folder, numbers as numbers; none if it has none. They may be packed by gzip.

    Raises:
        UsageError: A line is no row.
    """
    file, packed = path / TRIALS_FILE, path / PACKED_FILE
    if not file.is_file() and not packed.is_file():
        return []
    with file.open(newline="") if file.is_file() else gzip.open(packed, "rt", newline="") as text:
        return [_row(row, f"Line {line} of {file}") for line, row in enumerate(csv.DictReader(text), start=2)]


def checkpoints_of(run: dict[str, Any], rows: Sequence[Row]) -> list[str]:
    """Return the SHA-256 of the checkpoints of a run that ran some of its trials, each once."""
    ran = {str(row.get("agent")) for row in rows}
    named = zip(run.get("checkpoint", []), run.get("checkpoint_sha256", []), strict=False)
    return list(dict.fromkeys(digest for path, digest in named if path in ran or digest[:HASH] in ran))


def read_run(path: Path) -> dict[str, Any]:
    """Return what a result folder says of its run.

    Raises:
        UsageError: It is no result folder.
    """
    try:
        run = json.loads((path / RUN_FILE).read_text())
    except (OSError, json.JSONDecodeError) as error:
        raise UsageError(
            f"{path} is no folder of an evaluation: {RUN_FILE} is missing or damaged ({error})."
        ) from error
    if wrong := fault(run):
        raise UsageError(f"{path / RUN_FILE} is damaged: {wrong}.")
    return run


def _row(cells: dict[str, Any], label: str) -> Row:
    """Return a row with its numbers."""
    count = sum(cell is not None for name, cell in cells.items() if name is not None)
    if None in cells or count < len(cells):
        given = count + len(cells.get(None, ()))  # type: ignore[call-overload]
        raise UsageError(f"{label} has {given} cells, expected {len(cells) - (None in cells)}, as the heading has.")
    try:
        return {name: _value(name, cell) for name, cell in cells.items()}
    except ValueError as error:
        raise UsageError(f"{label} is no row: {error}.") from error


def _value(name: str, cell: str) -> Any:
    if name in ("trial", "seed", "group", "success"):
        return int(cell)
    if name in TEXTS:
        return cell
    try:
        return float(cell)
    except ValueError:
        return cell


def _write_run(file: Path, run: dict[str, Any]) -> None:
    """Write what was run, whole or not at all."""
    temporary = file.with_suffix(".tmp")
    temporary.write_text(json.dumps(run, indent=1, sort_keys=True) + "\n")
    os.replace(temporary, file)


def _names(given: dict[str, Any], written: dict[str, Any]) -> dict[str, str]:
    """Return the written path of each checkpoint that is given, which may lie elsewhere now, or on another machine."""
    old, new = (
        list(zip(run.get("checkpoint", []), run.get("checkpoint_sha256", []), strict=False)) for run in (written, given)
    )
    paths = {digest: path for path, digest in old}
    return {path: path if (path, digest) in old else paths.get(digest, path) for path, digest in new}


def _check_same(file: Path, old: dict[str, Any], new: dict[str, Any]) -> None:
    for name in IDENTITY:
        if old.get(name) != new.get(name):
            raise UsageError(
                f"{file} is of another evaluation: {name} is {old.get(name)!r} there and {new.get(name)!r} now. "
                "Give another --out."
            )
    versions = [run.get("versions", {}) for run in (old, new)]
    for name in sorted({*versions[0], *versions[1]} - {*ANY_VERSION}):
        before, now = (version.get(name) for version in versions)
        if all(versions) and before != now:
            raise UsageError(
                f"{file} was begun with {name} {before}, and now it is {now}: rows of other code do not belong "
                "together. Go back to it, or give another --out."
            )
    machines = [run.get("machine") for run in (old, new)]
    if all(machines) and machines[0] != machines[1]:
        raise UsageError(
            f"{file} was begun on {machines[0]}, and now it is {machines[1]}: rows of different devices differ in the "
            "last digits and do not belong together. Go on there, or give another --out."
        )


def _cut_torn_line(file: Path) -> None:
    """Remove a last line that was not written whole."""
    if file.is_file():
        with file.open("r+b") as rows:
            rows.truncate(rows.read().rfind(b"\n") + 1)
