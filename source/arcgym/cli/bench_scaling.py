# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measure how much faster one training run gets with more GPUs, physics and learning together.

Each number of processes is a run of its own, started by torchrun, with the same worlds on each GPU. Run for example::

    arcgym bench scaling --task ARC-Sigmoid-Magnetic --processes 1,2 --num_envs 1024 --json
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

from arcgym.cli.arguments import counts, positive, whole

TAKES_OVERRIDES = True


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the run and the numbers of processes."""
    parser.add_argument("--task", default="ARC-Sigmoid-Magnetic", help="task (default: ARC-Sigmoid-Magnetic)")
    parser.add_argument("--agent", default="ppo", help="agent (default: ppo)")
    parser.add_argument(
        "--processes", type=counts, default=[1, 2], help="numbers of processes, one a GPU (default: 1,2)"
    )
    parser.add_argument("--device", default="cuda", choices=("cuda", "cpu"), help="cuda (default) or cpu")
    parser.add_argument("--num_envs", type=positive, default=1024, help="worlds of each process (default: 1024)")
    parser.add_argument("--iterations", type=whole(4), default=12, help="updates; the first three do not count")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object on the last line")


def run(args: argparse.Namespace) -> int:
    """Measure every number of processes; return 1 if one failed."""
    from arcgym.benchmarks.scaling.measure import Settings, add_factors, measure
    from arcgym.rl.device import choose_device

    choose_device(args.device if args.device == "cpu" else f"cuda:{max(args.processes) - 1}")
    settings = Settings(args.task, args.agent, args.device, args.num_envs, args.iterations, args.overrides)
    rows: list[dict] = []
    with tempfile.TemporaryDirectory() as folder:
        for processes in args.processes:
            rows.append(measure(settings, processes, Path(folder) / f"{processes}"))
            add_factors(rows)
            print("  ".join(f"{name} {value}" for name, value in rows[-1].items()), flush=True)
    if args.json:
        from arcgym.benchmarks.hardware import full_name

        device = full_name("cpu" if args.device == "cpu" else "cuda:0")
        print(
            json.dumps({"benchmark": "scaling", "device": device, "task": args.task, "agent": args.agent, "rows": rows})
        )
    return 1 if any("error" in row for row in rows) else 0
