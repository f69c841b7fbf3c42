# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The leaderboard: submitted result folders, their figures computed anew. Loads neither torch nor Warp."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import MISSING, dataclass, fields
from pathlib import Path
from typing import Any

import yaml

from arcgym.evaluation.check import problems
from arcgym.evaluation.result_folder import COMMIT, read_run, read_trial_rows, result_folders
from arcgym.evaluation.results import back_off_of, roll_of
from arcgym.evaluation.statistics import Interval
from arcgym.evaluation.suites import read_suites
from arcgym.evaluation.summary import summarize
from arcgym.evaluation.task_settings import PHYSICS_STEP, marks
from arcgym.utils.errors import UsageError

ENTRY_FILE = "entry.yaml"
"""What a submission says of itself."""
NUMBERS = ("transitions", "gpu_hours")
"""Fields that are numbers; the others are lines of text."""
BEGIN, END = "<!-- entries -->", "<!-- end of entries -->"
"""Marks of the page between which the tables stand."""
METRICS = {"progress": ("progress", 2), "seconds": ("time [s]", 1), "p95_shaft_force": ("p95 shaft force [N]", 2)}
"""Heading and digits of the figures beside success."""


@dataclass(frozen=True)
class Entry:
    """A submission: ``entry.yaml`` beside ``run.json`` and ``trials.csv``."""

    name: str
    """Name of the method."""

    by: str
    """Who submits it."""

    sees: str
    """Observation groups of the policy at test time, such as ``policy``."""

    trained_on: str
    """Patients that anything of it was trained or chosen on."""

    transitions: float
    """Transitions of one training run, all stages and teachers included."""

    gpu_hours: float
    """Hours of one training run, times its GPUs."""

    url: str = ""
    """Code and checkpoint."""

    reproduced: str = ""
    """Who ran the checkpoint again, and when; empty for self-reported."""


def read_entry(folder: Path) -> Entry:
    """Return what a submission says of itself.

    Raises:
        UsageError: The file is missing or damaged, or a field is missing, unknown or of another kind.
    """
    path = folder / ENTRY_FILE
    try:
        values = yaml.safe_load(path.read_text())
    except (OSError, yaml.YAMLError) as error:
        raise UsageError(f"{path} cannot be read: {error}") from error
    known = {field.name: field for field in fields(Entry)}
    values = values if isinstance(values, dict) else {}
    missing = [name for name, field in known.items() if field.default is MISSING and name not in values]
    unknown = [name for name in values if name not in known]
    if missing or unknown:
        raise UsageError(
            f"{path} lacks {', '.join(missing) or 'nothing'} and has the unknown {', '.join(unknown) or 'nothing'}; "
            f"expected {', '.join(known)}."
        )
    return Entry(**{name: _typed(path, name, value) for name, value in values.items()})


def _typed(path: Path, name: str, value: Any) -> Any:
    """Return a value of an entry as its field has it; YAML takes 2e6, without a dot, for a text."""
    if name in NUMBERS:
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if not 0.0 <= number < math.inf:
            raise UsageError(f"{path} has {name} = {value!r}, expected a number that is not negative, such as 2.0e+6.")
        return number
    if not isinstance(value, str | int | float):
        raise UsageError(f"{path} has {name} = {value!r}, expected a line of text.")
    return str(value).replace("|", "/").replace("\n", " ").strip()


def submissions(folder: Path) -> tuple[list[Path], dict[Path, list[str]]]:
    """Return the submissions in a folder that can be shown, and what is wrong with the others, a line each."""
    good, refused = [], {}
    for path in result_folders(folder):
        try:
            found = problems(path)
        except UsageError as error:
            found = [str(error)]
        found += _entry_problems(path)
        if found:
            refused[path] = found
        else:
            good.append(path)
    return good, refused


def _entry_problems(folder: Path) -> list[str]:
    """Return what is wrong with what a submission says of itself, none or one line."""
    try:
        agent = read_run(folder).get("agent")
    except UsageError:
        return []  # said by the check
    if agent != "checkpoint":
        return [f"is of the agent '{agent}', which is a baseline: an entry has checkpoints"]
    try:
        entry = read_entry(folder)
    except UsageError as error:
        return [str(error)]
    said = {name.strip() for name in str(entry.sees).split(",")}
    seen = {name for inputs in read_run(folder).get("inputs", {}).values() for name in inputs["sees"]}
    return [f"says that it sees {entry.sees}, and saw {', '.join(sorted(seen))}"] if seen - said else []


def entries_table(folders: Sequence[Path]) -> str:
    """Return a table a suite, computed from the trials of each submission.

    The best comes first, and those of an earlier physics step last.
    """
    parts = []
    for suite in read_suites():
        own = [folder for folder in folders if read_run(folder)["suite"] == suite]
        lines = sorted((line for folder in own for line in _lines(folder)), key=lambda line: line[:3])
        if lines:
            columns = ["task", "method", "by", "success [%]", *(heading for heading, _ in METRICS.values())]
            columns += ["sees", "trained on", "transitions", "GPU hours", "checkpoint", "ARCGym"]
            columns += ["physics step", "marked"]
            head = [f"| {' | '.join(columns)} |", f"|{'---|' * len(columns)}"]
            parts.append("\n".join([f"## {suite}\n", *head, *(line[3] for line in lines)]))
    return "\n\n".join(parts) + "\n" if parts else "There is no entry yet.\n"


def write_leaderboard(page: Path, folders: Sequence[Path]) -> None:
    """Write the tables into a page, between its two marks; a page that is not there is made.

    Raises:
        UsageError: The page has no marks.
    """
    text = page.read_text() if page.exists() else f"# Leaderboard\n\n{BEGIN}\n{END}\n"
    if BEGIN not in text or END not in text:
        raise UsageError(f"{page} has no place for the tables; expected the lines '{BEGIN}' and '{END}' in it.")
    page.write_text(f"{text[: text.index(BEGIN) + len(BEGIN)]}\n{entries_table(folders)}{text[text.index(END) :]}")


def _lines(folder: Path) -> list[tuple[str, bool, float, str]]:
    """Return the line of the table of each task of a submission, and what it is sorted by before it.

    These are the task, whether the physics step is an earlier one, and success, the largest first.
    """
    entry, run = read_entry(folder), read_run(folder)
    name = f"[{entry.name}]({entry.url})" if entry.url else entry.name
    hashes = ", ".join(digest[:8] for digest in run["checkpoint_sha256"]) or run["agent"]
    marked = f"reproduced: {entry.reproduced}" if entry.reproduced else "self-reported"
    about = [
        entry.sees,
        entry.trained_on,
        f"{entry.transitions:.3g}",
        f"{entry.gpu_hours:g}",
        hashes,
        _version(run),
    ]
    lines = []
    for task, summary in summarize(read_trial_rows(folder)).items():
        figures = [
            _text(summary[metric], digits) if metric in summary else "" for metric, (_, digits) in METRICS.items()
        ]
        earlier = marks(run, task)
        cells = [f"`{task}`", name + _added(run, task), entry.by, _text(summary["success"], 0, 100.0), *figures, *about]
        cells += [PHYSICS_STEP.as_text(PHYSICS_STEP.in_run(run, task)) + earlier, marked]
        lines.append((task, bool(earlier), -summary["success"].value, f"| {' | '.join(cells)} |"))
    return lines


def _added(run: dict[str, Any], task: str) -> str:
    """Return in words what is added to an entry's commands in a task, and nothing where nothing is."""
    amplitude, speed = roll_of(run, task), 1000.0 * back_off_of(run, task)
    rolls = f", with a roll to and fro of {amplitude:g} rad/s" if amplitude else ""
    return rolls + (f", going back at {speed:g} mm/s where its tether no longer comes on" if speed else "")


def _version(run: dict[str, Any]) -> str:
    """Return which ARCGym was run: the commit where it is known, else the release."""
    versions = run.get("versions", {})
    return str(versions.get(COMMIT) or versions.get("arcgym", "?"))[:7]


def _text(interval: Interval, digits: int, factor: float = 1.0) -> str:
    value, low, high = (f"{factor * number:.{digits}f}" for number in (interval.value, interval.low, interval.high))
    return f"{value} ({low}–{high})"
