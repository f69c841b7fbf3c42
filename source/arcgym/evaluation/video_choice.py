# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Which trials of an evaluation are filmed, and where the films are. Loads neither torch nor Warp."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from arcgym.evaluation.result_folder import Row

VIDEOS = "videos"
"""Folder of the films in a result folder."""


def chosen_rows(rows: Sequence[Row]) -> dict[str, Row]:
    """Return the best, the median and the worst row of a task: by success, then progress, then the shorter time.

    Of fewer than three rows there are the best and the worst, of one the best.
    """
    ordered = sorted(rows, key=lambda row: (row["success"], row.get("progress", 0.0), -row["seconds"]))
    chosen = {"best": ordered[-1]}
    if len(ordered) > 2:
        chosen["median"] = ordered[len(ordered) // 2]
    if len(ordered) > 1:
        chosen["worst"] = ordered[0]
    return chosen


def video_path(folder: Path, row: Row, label: str) -> Path:
    """Return the film of a trial that is the best, median or worst of its task."""
    task = row["task"].replace(":", "_")
    return folder / VIDEOS / f"{task}_{label}_trial_{row['trial']}.mp4"
