# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Small copies of result folders, for a repository: what the page of results is made of. Loads no torch."""

from __future__ import annotations

import csv
import gzip
import io
import json
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from typing import Any

from arcgym.evaluation.baselines import FIGURES
from arcgym.evaluation.result_folder import HASH, PACKED_FILE, RUN_FILE, TRIALS_FILE, Row
from arcgym.evaluation.results import Result
from arcgym.evaluation.results_page import METRICS
from arcgym.evaluation.row_checks import BASIC
from arcgym.utils.errors import UsageError

COLUMNS = tuple(dict.fromkeys((*BASIC, *METRICS, *FIGURES, "centered_rate")))
"""Columns that are kept: those of the page and of the baselines, and what the check of a result folder asks for."""

DIGITS = 5
"""Significant digits that are kept: a figure of the page has three."""

LONG = 20
"""Trials beyond which a file is packed."""

PARTS = 3
"""Names of a checkpoint's path that are kept: cell, run and file."""


def keep(results: Sequence[Result], out: Path) -> int:
    """Write a small copy of each result folder, named after it, and return their number.

    Paths of checkpoints lose all but their last names, and rows name them by their hash; seeds and trials stay.

    Raises:
        UsageError: Two folders have one name.
    """
    folders = list(dict.fromkeys(one.folder for one in results))
    names = [folder.name for folder in folders]
    if len(set(names)) < len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        raise UsageError(f"Result folders need names of their own to be kept; there are several {', '.join(twice)}.")
    for folder in folders:
        own = [one for one in results if one.folder == folder]
        _write(out / folder.name, own[0].run, [row for one in own for row in one.rows])
    return len(folders)


def _write(folder: Path, run: dict[str, Any], rows: Sequence[Row]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    short = {**run, "checkpoint": [_short(path) for path in run.get("checkpoint", [])]}
    (folder / RUN_FILE).write_text(json.dumps(short, indent=1, sort_keys=True) + "\n")
    columns = [name for name in COLUMNS if name in rows[0]]
    digests = zip(run.get("checkpoint", []), run.get("checkpoint_sha256", []), strict=True)
    agents = {path: digest[:HASH] for path, digest in digests}
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        named = {**row, "agent": agents.get(row["agent"], row["agent"])}
        writer.writerow([_text(named[name]) for name in columns])
    for old in (PACKED_FILE, TRIALS_FILE):
        (folder / old).unlink(missing_ok=True)
    content = out.getvalue().encode()
    if len(rows) > LONG:
        (folder / PACKED_FILE).write_bytes(gzip.compress(content, mtime=0))
    else:
        (folder / TRIALS_FILE).write_bytes(content)


def _text(value: Any) -> str:
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else str(value)


def _short(path: str) -> str:
    return "/".join(PurePosixPath(path).parts[-PARTS:])
