# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Check a result folder before it is published; ends with status 1 if something is wrong.

arcgym results check results/mine
"""

from __future__ import annotations

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("folder", metavar="FOLDER", help="result folder")


def run(namespace: argparse.Namespace) -> int:
    """Print what is wrong, a line each."""
    from arcgym.evaluation.check import problems

    found = problems(Path(namespace.folder))
    for line in found:
        print(f"refused: {line}")
    if not found:
        print(f"{namespace.folder}: all trials of its suite are there, with the seeds of the condition file.")
    return 1 if found else 0
