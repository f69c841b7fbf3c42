# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measure how far the robots' scripted experts get in many patients, how fast, with which forces, and what stops them.

Several worlds of a patient work together, and several patients are driven at once. Each patient's row is appended to
``rows.jsonl`` in OUT as soon as the drive has ended there, and ``table.md`` at the end. The same command goes on where
it was stopped: with the patients that have no row yet, from the anus, or with ``--halts`` from where they were.
Run for example::

    arcgym bench experts --device cuda:0 --out logs/experts
    arcgym bench experts --colons colon_1 colon_2 --robots capsule --tissues paper --worlds 4 --out logs/experts
    arcgym bench experts --tissues paper --out logs/experts env.clinical=[all]

Overrides are those of the robots' tasks; their rows say so after the tissue.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from arcgym.cli.arguments import positive
from arcgym.utils.errors import UsageError
from arcgym.utils.lines import append_line

TAKES_OVERRIDES = True
ROBOTS = ("capsule", "magnetic", "proximal")
"""Robots that have an expert, as the rows name them."""
TISSUES = ("paper", "in_situ")
"""Tissue presets that are driven through where none are given."""
GPU_WORLDS, CPU_WORLDS = 12, 4
"""Worlds of each patient where none are given."""
HELD = ("max_time", "patience", "seed")
"""Settings that all rows of a folder share."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare patients, robots, tissues and where the rows go."""
    parser.add_argument(
        "--colons", nargs="+", default=["population:validation"], help="stages, folders or splits (all of validation)"
    )
    parser.add_argument("--num_patients", type=positive, help="how many of them, from the first (all)")
    parser.add_argument("--robots", nargs="+", choices=ROBOTS, default=list(ROBOTS), help="robots (all)")
    parser.add_argument("--tissues", nargs="+", default=list(TISSUES), help="tissue presets (paper in_situ)")
    parser.add_argument(
        "--worlds", type=positive, help=f"worlds for each patient (GPU: {GPU_WORLDS}, CPU: {CPU_WORLDS})"
    )
    parser.add_argument("--batch", type=positive, default=32, help="patients at once (32)")
    parser.add_argument("--max_time", type=float, default=240.0, help="simulated time for a patient [s] (240)")
    parser.add_argument(
        "--patience", type=float, default=30.0, help="simulated time without progress after which it gives up [s] (30)"
    )
    parser.add_argument(
        "--length", type=float, help="length of the scopes with a shaft [m]; all but 0.2 m can be inserted (1.68)"
    )
    parser.add_argument("--minutes", type=float, default=float("inf"), help="longest time in all (no limit)")
    parser.add_argument("--states", action="store_true", help="keep the start states in the cache folder")
    parser.add_argument(
        "--halts", type=Path, help="folder that keeps drives for which --minutes were not enough, to go on with them"
    )
    parser.add_argument(
        "--ways",
        type=Path,
        help="folder that keeps the foremost world's state every 4 cm, for scripts/tools/film_way.py",
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the experts' settings (0)")
    parser.add_argument("--device", help="cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)")
    parser.add_argument("--out", type=Path, required=True, help="folder of the rows and the table")


def run(args: argparse.Namespace) -> None:
    """Drive where no row is yet, then write the table.

    Raises:
        UsageError: If there are no such stages.
    """
    from arcgym.assets.patient_files import find_stages
    from arcgym.benchmarks.experts.table import failures, read_rows, table
    from arcgym.utils.made_by import check_made_by

    began = time.monotonic()
    try:
        stages = find_stages(args.colons, args.num_patients)
    except (ValueError, OSError) as error:
        raise UsageError(str(error)) from error
    check_made_by(args.out, {name: getattr(args, name) for name in HELD}, "rows.jsonl")
    rows = args.out / "rows.jsonl"
    for robot, tissue in product(args.robots, args.tissues):
        label = " ".join((tissue, *args.overrides))
        for batch in _missing(read_rows(rows), robot, label, args.length, stages, args.batch):
            if time.monotonic() - began < 60.0 * args.minutes:
                _drive(args, robot, tissue, batch, rows, began + 60.0 * args.minutes)
    done = read_rows(rows)
    text = f"{table(done)}\n\n{failures(done)}\n"
    (args.out / "table.md").write_text(text)
    print(text)


def _missing(
    rows: Sequence[dict[str, Any]], robot: str, tissue: str, length: float | None, stages: Sequence[Path], size: int
) -> Iterator[list[Path]]:
    """Yield batches of the stages that have no row yet."""
    wanted = robot, tissue, length
    there = {row["patient"] for row in rows if (row["robot"], row["tissue"], row.get("scope_length")) == wanted}
    left = [stage for stage in stages if stage.resolve().parent.name not in there]
    for first in range(0, len(left), size):
        yield left[first : first + size]


def _drive(
    args: argparse.Namespace, robot: str, tissue: str, stages: Sequence[Path], rows: Path, deadline: float
) -> None:
    """Drive one batch, appending rows as they come; those for which there was no time left are not written."""
    from arcgym.benchmarks.experts.measure import Attempt, attempt
    from arcgym.benchmarks.worlds import OUT_OF_TIME
    from arcgym.rl.device import choose_device

    device = choose_device(args.device)
    worlds = args.worlds or (CPU_WORLDS if device == "cpu" else GPU_WORLDS)

    def done(row: dict[str, Any]) -> None:
        name = "rows.jsonl" if row["problem"] != OUT_OF_TIME else "unfinished.jsonl"
        append_line(rows.with_name(name), json.dumps(row))
        end = row["problem"] or "arrived"
        print(
            f"{row['patient']}, {robot}, {tissue}: {row['reached']:.2f} of {row['length']:.2f} m in {row['time']:.0f} s"
            f" ({end}; {row['held_by']})",
            flush=True,
        )

    how = {"keep_states": args.states, "patience": args.patience, "length": args.length, "halts": args.halts}
    how["ways"] = args.ways
    how["overrides"] = tuple(args.overrides)
    plan = Attempt(robot, tissue, worlds, args.max_time, device, args.seed, deadline, **how)
    attempt(plan, stages, done, lambda text: print(f"{robot}, {tissue}: {text}", flush=True))
