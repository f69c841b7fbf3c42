# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""One result folder of several: an evaluation that was shared by machines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from arcgym.evaluation.result_folder import DROPPED, ResultFolder, read_run, read_trial_rows
from arcgym.evaluation.task_settings import SETTINGS
from arcgym.utils.errors import UsageError


def merge(parts: Sequence[Path], out: Path) -> ResultFolder:
    """Write the rows of several folders of the same evaluation into one, and what differs from the registered tasks.

    Raises:
        UsageError: A folder is of another evaluation, or two have different results of the same trial, or ran the same
            task with other settings.
    """
    folder = ResultFolder(out, read_run(parts[0]))
    dropped: Counter[str] = Counter()
    known = {(row["task"], row["trial"]): row for row in folder.rows}
    for part in parts:
        run = read_run(part)
        names = ResultFolder(out, run).names
        _merge_settings(folder, part, run)
        for task, inputs in run.get("inputs", {}).items():
            folder.note_inputs(task, inputs)
        dropped.update(run.get(DROPPED, {}))
        for row in read_trial_rows(part):
            row["agent"] = names.get(row["agent"], row["agent"])
            key = (row["task"], row["trial"])
            if key not in known:
                known[key] = row
                folder.add(row)
            elif known[key] != row:
                raise UsageError(
                    f"{part} has another result of trial {key[1]} of {key[0]} than the folders before: trials of "
                    "different devices differ in the last digits, run each trial on one."
                )
    for task, contacts in dropped.items():  # the folder may have the count of these parts, or of trials before them
        folder.note_dropped(task, max(contacts, folder.dropped(task)))
    return folder


def _merge_settings(folder: ResultFolder, part: Path, run: dict[str, Any]) -> None:
    notes: dict[str, Callable[[str, Any], None]] = {"changes": folder.note_changes}
    notes |= {setting.entry: partial(folder.note_setting, setting) for setting in SETTINGS}
    for entry, note in notes.items():
        before = read_run(folder.path).get(entry, {})
        for task, value in run.get(entry, {}).items():
            if before.get(task, value) != value:
                raise UsageError(
                    f"{part} ran {task} with other settings than the folders before: '{entry}' in run.json."
                )
            note(task, value)
