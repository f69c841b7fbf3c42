# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw an evaluation as a page: one HTML file with tables and pictures inside.

arcgym results page results/mine
"""

from __future__ import annotations

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("folder", metavar="FOLDER", help="result folder")


def run(namespace: argparse.Namespace) -> None:
    """Write the page and say where it is."""
    from arcgym.evaluation.page import write_page
    from arcgym.rl.agent_checks import check_installed

    check_installed("matplotlib", "the page", "study")
    print(f"page: {write_page(Path(namespace.folder))}")
