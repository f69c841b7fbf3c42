# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Make table and pictures of a study's folder again, while it runs or later.

arcgym study report logs/studies/keys
"""

from __future__ import annotations

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("folder", metavar="FOLDER", help="folder of a study, such as logs/studies/keys")


def run(namespace: argparse.Namespace) -> int:
    """Write curves, table and pictures, and return 0 when all cells are finished."""
    from arcgym.cli.study import report
    from arcgym.studies.cell import read_cells
    from arcgym.utils.errors import UsageError

    folder = Path(namespace.folder).resolve()
    cells = read_cells(folder)
    if not cells:
        raise UsageError(f"{namespace.folder} holds no cell of a study.")
    return report(folder, cells)
