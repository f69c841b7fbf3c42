# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Show an evaluation in the layout of the paper's tables, beside the paper's figures.

    arcgym results paper results/material            # the table of the folder's suite
    arcgym results paper results/mine --table forces
    arcgym results paper logs/studies/reward_ablation

Writes <table>.md into the folder.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("folder", metavar="FOLDER", help="result folder")
    parser.add_argument("--table", help="paper, material, anchors, cross_colon, rigid or forces (default: the suite's)")


def run(namespace: argparse.Namespace) -> None:
    """Print the table and write it."""
    from arcgym.evaluation.paper_tables import paper_table
    from arcgym.evaluation.result_folder import read_run, read_trial_rows

    folder = Path(namespace.folder)
    is_study = (folder / "episodes.csv").is_file()
    name = namespace.table or (folder.resolve().name if is_study else str(read_run(folder).get("suite")))
    text = paper_table(study_rows(folder) if is_study else read_trial_rows(folder), name)
    print(text)
    path = folder / f"{name}.md"
    path.write_text(text)
    print(f"table: {path}")


def study_rows(folder: Path) -> list[dict[str, Any]]:
    """Return the episodes of a study as rows of trials; those of a policy without its rules are left out."""
    from arcgym.rl.studies.cell import read_cells
    from arcgym.rl.studies.table import all_episodes

    cells = {cell.name: cell for cell in read_cells(folder)}
    rows = []
    for row in all_episodes(list(cells.values())):
        cell = cells[row["cell"]]
        about = {"task": cell.task, "algorithm": cell.algorithm, "group": cell.seed}
        if row["rules"] != "off":
            rows.append({**row, **about, "trained_with": cell.axes.get("env.reward", "")})
    return rows
