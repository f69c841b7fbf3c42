# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measure how many pictures the endoscope camera draws in a second, without any physics.

Every world gets its own copy of a colon at rest and a camera on its centerline. One update skins the surface, refits
the ray tree and draws color and depth. Run for example::

    arcgym bench camera --device cuda:0 --num_envs 1 64 256 1024 --size 64 84 128 --json
"""

from __future__ import annotations

import argparse
import json

from arcgym.cli.arguments import positive
from arcgym.utils.errors import UsageError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the colon, the worlds and the pictures."""
    parser.add_argument("--colon", default="colon_1/colon.usda", help="stage of the colon (file, or inside assets)")
    parser.add_argument("--device", default="cpu", help="cpu or cuda:0")
    parser.add_argument("--num_envs", type=positive, nargs="+", default=[1, 4], help="numbers of worlds")
    parser.add_argument("--size", type=positive, nargs="+", default=[84], help="edges of the square picture [px]")
    parser.add_argument("--samples", type=positive, default=1, help="rays per pixel")
    parser.add_argument("--repeats", type=positive, default=20, help="timed updates; the median counts")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object on the last line")


def run(args: argparse.Namespace) -> None:
    """Measure every combination of world count and picture size."""
    from arcgym.anatomy import StageError, read_colon
    from arcgym.benchmarks.camera.measure import time_updates
    from arcgym.benchmarks.hardware import full_name
    from arcgym.rl.device import choose_device
    from arcgym.utils.paths import resolve_asset

    device = choose_device(args.device)
    try:
        stage = read_colon(resolve_asset(args.colon))
    except (StageError, FileNotFoundError) as error:
        raise UsageError(f"--colon: {error}") from error
    results = []
    for num_envs in args.num_envs:
        for size in args.size:
            results.append(time_updates(stage, num_envs, size, device, args.samples, args.repeats))
            print("  ".join(f"{key} {value}" for key, value in results[-1].items()), flush=True)
    if args.json:
        report = {"benchmark": "camera", "colon": args.colon, "device": full_name(device), "results": results}
        print(json.dumps(report))
