# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Compare scripted insertions of the pushed colonoscope with what is published of real ones.

Each variant drives up all patients. The insertions are written to OUT/VARIANT/PATIENT.npz, the figures of all that are
there to ``figures.json`` and, beside the published ones, to ``table.md``. Called again for the same folder, it goes on
with insertions that ran out of ``--minutes``, and makes those that are not there. Run for example::

    arcgym bench clinical --colons population:validation --num_patients 20 --device cuda:0 --out logs/clinical
    arcgym bench clinical --colons colon_1 ct_1 --variants clinical --worlds 1 --out logs/clinical
    arcgym bench clinical --table --out logs/clinical

Overrides of the task join those of every variant.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from arcgym.cli.arguments import positive
from arcgym.utils.errors import UsageError

TAKES_OVERRIDES = True
VARIANTS: dict[str, tuple[str, ...]] = {
    "paper": (),
    "in_situ": ("env.scene.colon.material=in_situ",),
    "clinical": ("env.clinical=[all]",),
    "examiner": ("env.clinical=[all]",),
}
"""Overrides by name; ``examiner`` has a script that pushes gently and pulls back."""
EXAMINER = "examiner"
"""Name of that variant."""
GPU_WORLDS, CPU_WORLDS = 6, 1
"""Worlds of each patient where none are given."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare patients, variants and where the insertions go."""
    parser.add_argument(
        "--colons", nargs="+", default=["population:validation"], help="stages, folders or splits (all of validation)"
    )
    parser.add_argument("--num_patients", type=positive, help="how many of them, from the first (all)")
    parser.add_argument("--variants", nargs="+", choices=VARIANTS, default=list(VARIANTS), help="variants (all)")
    parser.add_argument(
        "--worlds", type=positive, help=f"worlds for each patient (GPU: {GPU_WORLDS}, CPU: {CPU_WORLDS})"
    )
    parser.add_argument("--max_time", type=float, default=180.0, help="simulated time for a patient [s] (180)")
    parser.add_argument(
        "--patience", type=float, default=30.0, help="simulated time without progress after which it gives up [s] (30)"
    )
    parser.add_argument("--speed", type=float, help="speed of the scripts [m/s] (0.04, of the examiner's 0.015)")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="longest time in all (no limit)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the experts' settings (0)")
    parser.add_argument("--device", help="cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)")
    parser.add_argument("--table", action="store_true", help="only make the table of what is there")
    parser.add_argument("--out", type=Path, required=True, help="folder of the insertions and the table")


def run(args: argparse.Namespace) -> None:
    """Drive, then write figures and table.

    Raises:
        UsageError: If there are no such stages, or nothing is there to make a table of.
    """
    from arcgym.benchmarks.clinical.table import write_table

    if args.speed is not None and args.speed <= 0.0:
        raise UsageError(f"--speed is {args.speed:g}, expected more than 0")
    if not args.table:
        _drive(args)
    try:
        print(write_table(args.out))
    except ValueError as error:
        raise UsageError(f"--out: {error}") from error


def _drive(args: argparse.Namespace) -> None:
    """Make the insertions of every variant."""
    from arcgym.assets.patient_files import find_stages
    from arcgym.benchmarks.clinical.insertions import Plan, insert
    from arcgym.rl.device import choose_device
    from arcgym.utils.made_by import check_made_by

    names = ("max_time", "patience", "speed", "seed", "overrides")
    check_made_by(args.out, {name: getattr(args, name) for name in names}, "*/*.npz")
    began = time.monotonic()
    try:
        stages = find_stages(args.colons, args.num_patients)
    except (ValueError, OSError) as error:
        raise UsageError(str(error)) from error
    device = choose_device(args.device)
    worlds = args.worlds or (CPU_WORLDS if device == "cpu" else GPU_WORLDS)
    for name in args.variants:
        deadline = began + 60.0 * args.minutes
        overrides = (*VARIANTS[name], *args.overrides)
        examiner = name == EXAMINER
        plan = Plan(
            name, overrides, worlds, args.max_time, args.patience, device, examiner, args.speed, args.seed, deadline
        )
        insert(plan, stages, args.out, _say)


def _say(text: str) -> None:
    print(text, flush=True)
