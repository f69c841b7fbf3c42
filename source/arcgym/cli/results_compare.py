# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Compare two agents on the same trials: mean differences, second minus first, with 95 % intervals.

arcgym results compare results/first results/second
"""

from __future__ import annotations

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("first", metavar="FIRST", help="result folder of one agent")
    parser.add_argument("second", metavar="SECOND", help="result folder of the other")


def run(namespace: argparse.Namespace) -> None:
    """Print the table, and in what the runs differ beside their agents."""
    from arcgym.evaluation.compare import compare, notes, to_markdown

    first, second = Path(namespace.first), Path(namespace.second)
    table = to_markdown(compare(first, second))
    print(f"{second} minus {first}, the same trials:\n\n{table}")
    for line in notes(first, second):
        print(line)
