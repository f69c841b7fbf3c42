# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Write all tables of result folders as one page, with what was not run and the command that would make it.

    arcgym results summary docs/data/results --out docs/results.md --figure docs/images/results.png
    arcgym results summary logs/studies/paper_table/trials results --out docs/results.md --keep docs/data/results

Result folders lie anywhere below the given ones. Shown are those whose code, checkpoint and condition file are known;
the others are named, with the reason. --keep writes what the page needs of them, small enough for a repository.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

SHOWN = 3
"""Reasons that are shown of a folder that is left out."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("folders", metavar="FOLDER", nargs="+", help="folder with result folders in it")
    parser.add_argument("--out", required=True, help="page to write, such as docs/results.md")
    parser.add_argument("--figure", help="picture of the first table, such as docs/images/results.png (default: none)")
    parser.add_argument("--keep", help="folder that gets a small copy of each result folder that is shown")


def run(namespace: argparse.Namespace) -> None:
    """Write the page, and say what is left out and why."""
    from arcgym.evaluation.results import find_results
    from arcgym.evaluation.results_keep import keep
    from arcgym.evaluation.results_page import read_sections, results_page
    from arcgym.rl.agent_checks import check_installed
    from arcgym.utils.files import write_whole

    if namespace.figure:
        check_installed("matplotlib", "--figure", "study")
    results, left_out = find_results([Path(folder) for folder in namespace.folders])
    for path, reasons in left_out.items():
        more = f"; and {len(reasons) - SHOWN} more" if len(reasons) > SHOWN else ""
        print(f"left out: {path}: {'; '.join(reasons[:SHOWN])}{more}")
    folders, sections = list(namespace.folders), read_sections()
    if namespace.keep:
        suites = {section["suite"] for section in sections}
        count = keep([one for one in results if one.suite in suites], Path(namespace.keep))
        print(f"kept: {count} result folders in {namespace.keep}")
        folders = [namespace.keep]
        results, _ = find_results([Path(namespace.keep)])
    figure = None
    if namespace.figure:
        from arcgym.evaluation.results_figure import draw_results

        draw_results(results, sections[0], Path(namespace.figure))
        print(f"picture: {namespace.figure}")
        figure = os.path.relpath(namespace.figure, Path(namespace.out).parent)
    command = f"arcgym results summary {' '.join(folders)} --out {namespace.out}"
    command += f" --figure {namespace.figure}" if namespace.figure else ""
    text = results_page(results, command, sections, figure)
    write_whole(Path(namespace.out), text.encode())
    print(f"page: {namespace.out}, {len(results)} results")
