# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Make the leaderboard of submitted result folders; ends with status 1 if one is refused.

    arcgym results leaderboard docs/leaderboard                                  # check and print
    arcgym results leaderboard docs/leaderboard --page docs/leaderboard.md       # and write the page

Every folder below with a run.json is a submission, with an entry.yaml beside it. Its figures are computed from its
trials.
"""

from __future__ import annotations

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("folder", metavar="FOLDER", help="folder of the submissions")
    parser.add_argument("--page", help="page to write the tables into, between its two marks; made if not there")


def run(namespace: argparse.Namespace) -> int:
    """Print or write the tables, and say what is refused and why."""
    from arcgym.evaluation.leaderboard import entries_table, submissions, write_leaderboard

    good, refused = submissions(Path(namespace.folder))
    for path, found in refused.items():
        for line in found:
            print(f"refused: {path}: {line}")
    if namespace.page:
        write_leaderboard(Path(namespace.page), good)
        print(f"page: {namespace.page}, {len(good)} submissions")
    else:
        print(entries_table(good))
    return 1 if refused else 0
