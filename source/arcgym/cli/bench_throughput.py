# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measure how fast a task runs: physics, 84-pixel color and depth, rewards and resets, under random actions.

The tip is at the end of the segment when timing begins, so that the shaft fills it and lies against the wall. Every
number of worlds runs in a process of its own, so that its memory is measured clean; one that does not fit gives a row
with an error, and the others go on. Run for example::

    arcgym bench throughput --num_envs 1,64,1024 --device cuda:0 --stages --cold --bandwidth --json
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

from arcgym.benchmarks.throughput import launch, report
from arcgym.benchmarks.throughput.settings import Row, Settings
from arcgym.benchmarks.worlds import load_env_cfg
from arcgym.cli.arguments import counts, positive

TAKES_OVERRIDES = True
GPU_COUNTS, CPU_COUNTS = [1, 16, 64, 256, 1024, 4096], [1, 4]
"""Numbers of worlds that are measured where none are given."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--task", default="ARC-Sigmoid-Proximal", help="task name; `arcgym list` shows them")
    parser.add_argument("--num_envs", type=counts, help="numbers of worlds (default: 1,16,64,256,1024,4096; CPU: 1,4)")
    patients = "numbers of patients in a batch: the first of the colons that are configured, or variants of the one"
    parser.add_argument("--patients", type=counts, help=patients)
    parser.add_argument("--steps", type=positive, default=20, help="timed control steps (default: 20)")
    parser.add_argument("--device", help="cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)")
    parser.add_argument("--start", choices=("end", "entry"), default="end", help="where in the segment the tip is")
    parser.add_argument("--stages", action="store_true", help="time each part of a control step alone, too")
    parser.add_argument("--bandwidth", action="store_true", help="estimate memory traffic beside a measured copy's")
    parser.add_argument("--cold", action="store_true", help="use a fresh kernel cache, and start once more to fill it")
    parser.add_argument("--repeats", type=positive, default=7, help="timed calls of each stage (default: 7)")
    parser.add_argument("--seed", type=int, default=0, help="seed of environment and actions (default: 0)")
    parser.add_argument("--timeout", type=float, default=1800.0, help="longest run of one number of worlds [s]")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object on the last line")


def run(args: argparse.Namespace) -> None:
    """Measure every number of worlds and print the table."""
    from rich.console import Console

    cfg = load_env_cfg(args.task, args.overrides, args.seed)

    from arcgym.rl.device import choose_device
    from arcgym.rl.preflight import check_environment

    if args.patients and not cfg.scene.colon.num_patients:
        cfg.scene.colon.num_patients = 1  # of the colons that are configured the first is looked at
    check_environment(cfg, args.device)
    device = choose_device(args.device)
    num_envs = args.num_envs or (CPU_COUNTS if device == "cpu" else GPU_COUNTS)
    names = ("task", "steps", "repeats", "seed", "start", "stages", "bandwidth", "timeout")
    settings = Settings(device=device, **{name: getattr(args, name) for name in names})
    console = Console()
    console.print(f"{args.task} on {device}, median of {args.steps} control steps", highlight=False)
    print(report.headings(), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        cache = Path(folder) if args.cold else None
        rows = launch.run_all(settings, num_envs, args.overrides, show, cache, args.patients or (0,))
    if args.stages:
        console.print(report.stage_table(rows))
    if args.json:
        print(json.dumps({"device": report.device_name(rows, device), "task": args.task, "rows": rows}))


def show(row: Row) -> None:
    """Print a row as it comes."""
    print(report.describe(row), flush=True)
