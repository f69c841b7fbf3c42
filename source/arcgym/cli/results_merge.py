# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Put the result folders of several machines, which shared the trials of one evaluation, into one.

arcgym results merge results/whole results/part_1 results/part_2
"""

from __future__ import annotations

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("out", metavar="OUT", help="folder of all results")
    parser.add_argument("parts", metavar="PART", nargs="+", help="folders with parts of them")


def run(namespace: argparse.Namespace) -> None:
    """Write the folder, its summary and its Parquet."""
    from arcgym.evaluation.merge import merge
    from arcgym.evaluation.parquet import write_parquet
    from arcgym.evaluation.result_folder import SUMMARY_FILE
    from arcgym.evaluation.summary import report

    folder = merge([Path(part) for part in namespace.parts], Path(namespace.out))
    table = report(folder.rows)
    (folder.path / SUMMARY_FILE).write_text(table)
    print(table)
    write_parquet(folder.path)
