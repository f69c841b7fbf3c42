# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Show an evaluation in the layout of the paper's tables, beside the paper's figures.

    arcgym results paper results/material            # the table of the folder's suite
    arcgym results paper results/mine --table forces
    arcgym results paper results/rectum results/splenic    # tasks or policies that were evaluated one by one
    arcgym results paper logs/studies/reward_ablation
    arcgym results paper logs/studies/paper --table algorithms

Writes <table>.md into the first folder.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from arcgym.evaluation.result_folder import read_run, read_trial_rows
from arcgym.utils.errors import UsageError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("folders", metavar="FOLDER", nargs="+", help="result folder, or folder of a study")
    parser.add_argument("--table", help="name of the table, such as material or forces (default: the suite's)")


def run(namespace: argparse.Namespace) -> None:
    """Print the table and write it."""
    from arcgym.evaluation.paper_tables import paper_table

    folders = [Path(folder) for folder in namespace.folders]
    names = {namespace.table} if namespace.table else {_table_of(folder) for folder in folders}
    if len(names) > 1:
        raise UsageError(f"The folders are of {', '.join(sorted(names))}: give those of one suite, or --table.")
    (name,) = names
    text = paper_table([row for folder in folders for row in _rows(folder)], name)
    print(text)
    path = folders[0] / f"{name}.md"
    path.write_text(text)
    print(f"table: {path}")


def _is_study(folder: Path) -> bool:
    return (folder / "episodes.csv").is_file()


def _table_of(folder: Path) -> str:
    """Return the table of a folder: its suite, or the study's name."""
    return folder.resolve().name if _is_study(folder) else str(read_run(folder).get("suite"))


def _rows(folder: Path) -> list[dict[str, Any]]:
    return study_rows(folder) if _is_study(folder) else read_trial_rows(folder)


def study_rows(folder: Path) -> list[dict[str, Any]]:
    """Return the episodes of a study as rows of trials; those of a policy without its rules are left out."""
    from arcgym.studies.cell import read_cells
    from arcgym.studies.table import all_episodes

    cells = {cell.name: cell for cell in read_cells(folder)}
    rows = []
    for row in all_episodes(list(cells.values())):
        cell = cells[row["cell"]]
        about = {"task": cell.task, "algorithm": cell.algorithm, "group": cell.seed}
        if row["rules"] != "off":
            rows.append({**row, **about, "trained_with": cell.axes.get("env.reward", "")})
    return rows
