# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Train a grid of algorithms, tasks, robots and seeds, and make table and pictures of it.

    arcgym study keys --devices cuda:0,cuda:1 --per_device 3
    arcgym study my_study.yaml seed=1,2,3 --launcher submitit_slurm hydra.launcher.partition=gpu

CONFIG is a YAML file, or the name of a study that comes with the package. The study goes to logs/studies/<name>.
Called again, it leaves finished cells alone and goes on with the others from their checkpoints. A study with suites
runs their trials too, in trials/. Other arguments are overrides in Hydra's grammar: fields of the study, and
hydra.launcher.… for the launcher.
"""

from __future__ import annotations

import argparse
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.cli.arguments import add_fields, argument, positive, read_fields

TAKES_OVERRIDES = True

OVERRIDE = re.compile(r"[+~]*[A-Za-z_][\w.]*=.*|hydra/.*=.*", re.DOTALL)
"""Form of an override of a study."""

SHIPPED = Path(__file__).parents[2] / "arcgym_tasks" / "navigation" / "studies"
"""Folder of the studies that come with the package; their names are enough."""

LAUNCHERS = ("pool", "submitit_slurm", "submitit_local", "ray", "basic")
"""What can run the cells of a study: processes of this machine, or a launcher of Hydra."""


@dataclass(frozen=True, kw_only=True)
class StudyArguments:
    """Arguments of ``arcgym study`` that are flags."""

    folder: str | None = argument("folder of the study (default: logs/studies/<name>)", None)
    devices: str | None = argument("devices, such as cuda:0,cuda:1 (default: all GPUs, else cpu)", None)
    per_device: int = argument("cells at a time on each device (default: 1)", 1, type=positive)
    launcher: str = argument("where cells run (default: pool, this machine)", "pool", choices=LAUNCHERS)
    stop_after: float | None = argument(
        "minutes after which cells that run write a checkpoint and stop; call again to go on", None, type=float
    )
    dry_run: bool = argument("list the cells and their states, and run nothing", False)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("config", metavar="CONFIG", help="YAML file, or name of a study of the package")
    parser.override = OVERRIDE  # type: ignore[attr-defined]
    parser.epilog = "Any other argument is an override: minutes=5 seed=1,2,3 hydra.launcher.partition=gpu"
    add_fields(parser, StudyArguments)


def run(namespace: argparse.Namespace) -> int:
    """Run the study and return the exit status: 0 when all cells are finished, 1 when one failed, 3 when some wait."""
    from arcgym.studies.checks import check_cells, check_names
    from arcgym.studies.launch import LaunchOptions, all_cells, launch
    from arcgym.studies.study_cfg import find_study, read_study

    args = read_fields(StudyArguments, namespace)
    cfg = read_study(find_study(namespace.config, SHIPPED))
    changes = [f"++{text}" if text.startswith(("env.", "agent.")) else text for text in namespace.overrides]
    folder = Path(args.folder or Path("logs") / "studies" / cfg.name).resolve()
    check_names(cfg)
    cells = all_cells(cfg, folder, changes)
    check_cells(cells)
    if args.dry_run:
        for cell in cells:
            print(f"{cell.name}: {cell.read_state()['state']}")
        report_trials(cells, each=True)
        return 0
    devices = _devices(args.devices) if args.launcher == "pool" else ()
    print(f"study {cfg.name}: {len(cells)} cells, {folder}", flush=True)
    options = LaunchOptions(args.launcher, devices, args.per_device, args.stop_after, changes)
    launch(cfg, folder, options)
    status = report(folder, cells)
    return max(status, report_trials(cells)) if status != 1 else 1


def report_trials(cells: list[Any], each: bool = False) -> int:
    """Say in which state the trials of the study's suites are, and return 0 if all have ended, else 3.

    Args:
        cells: Cells of the study.
        each: Whether to name each result folder.
    """
    from arcgym.studies.suite_trials import all_trials

    found = [(trials, trials.state()) for trials in all_trials(cells)]
    for trials, state in found:
        if each or state == "of other policies":
            print(f"trials/{trials.suite}/{trials.name}: {state}")
    for suite in dict.fromkeys(trials.suite for trials, _ in found):
        states = Counter(state for trials, state in found if trials.suite == suite)
        print(f"trials of {suite}: {', '.join(f'{count} {state}' for state, count in states.items())}")
    return 0 if {state for _, state in found} <= {"finished"} else 3


def report(folder: Path, cells: list[Any]) -> int:
    """Write curves, table and pictures, say where they are and how many cells are in which state; return the status.

    Table and pictures show the folder's other cells too, which an earlier call with other settings has left.
    """
    from arcgym.studies.cell import read_cells
    from arcgym.studies.curves import make_curves
    from arcgym.studies.table import write_table

    shown = list({cell.name: cell for cell in [*cells, *read_cells(folder)]}.values())
    for cell in shown:
        if cell.runs:
            make_curves(cell)
    write_table(folder, shown)
    print(f"table: {folder / 'table.md'}")
    for path in draw(folder, shown):
        print(f"picture: {path}")
    states = Counter(cell.read_state()["state"] for cell in cells)
    print(f"cells: {', '.join(f'{count} {state}' for state, count in states.items())}")
    for cell in cells:
        if cell.read_state()["state"] == "failed":
            print(f"failed: {cell.name}, see {cell.folder / 'log.txt'}")
    return 1 if states["failed"] else 0 if states["finished"] == len(cells) else 3


def draw(folder: Path, cells: list[Any]) -> list[Path]:
    """Draw the pictures and return their paths; without matplotlib there is none."""
    import importlib.util

    if importlib.util.find_spec("matplotlib") is None:
        print("pictures: none, they need matplotlib (pip install 'arcgym[study]')")
        return []
    from arcgym.studies.figures import draw_curves, draw_pareto

    paths = [folder / "curves.png", folder / "pareto.png"]
    draw_curves(cells, paths[0], folder.name)
    draw_pareto(cells, paths[1], folder.name)
    return paths


def _devices(given: str | None) -> list[str]:
    """Return the devices that were asked for, or all GPUs, or the CPU."""
    from arcgym.rl.device import choose_device

    if given is not None:
        return [choose_device(name.strip()) for name in given.split(",")]
    import torch

    return [f"cuda:{index}" for index in range(torch.cuda.device_count())] or ["cpu"]
