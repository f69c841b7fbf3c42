# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measure how long agents take for an update: plain, in mixed precision, and compiled.

The environment is noise with the shapes of a navigation task and costs hardly any time, so that the figures are of
networks and memory alone. Run for example::

    arcgym bench learner --device cuda:0 --agents ppo,ppo_recurrent,sac --num_envs 512 --json
"""

from __future__ import annotations

import argparse
import json

from arcgym.cli.arguments import positive

TAKES_OVERRIDES = True


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare agents, variants and shapes."""
    parser.add_argument("--task", default="ARC-Rectum-Magnetic", help="task whose agents are measured")
    parser.add_argument("--agents", default="ppo,ppo_recurrent,sac", help="agents, with commas between")
    parser.add_argument("--variants", default="plain,amp,compile,amp+compile", help="of these, with commas between")
    parser.add_argument("--device", help="cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)")
    parser.add_argument("--num_envs", type=positive, default=512, help="worlds (default: 512)")
    parser.add_argument("--size", type=positive, default=84, help="edge of the images [px] (default: 84)")
    parser.add_argument("--repeats", type=positive, default=10, help="timed updates; the median counts (default: 10)")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object on the last line")


def run(args: argparse.Namespace) -> None:
    """Measure every agent in every variant; one that fails gives a row with its error, and the others go on."""
    from arcgym.cli.task import agent_key
    from arcgym.rl.device import choose_device
    from arcgym.utils.errors import UsageError
    from arcgym.utils.hydra import apply_overrides
    from arcgym.utils.registry import load_cfg_from_registry
    from arcgym.utils.string import did_you_mean

    device = choose_device(args.device)

    from arcgym.benchmarks.hardware import full_name
    from arcgym.benchmarks.learner.measure import VARIANTS, Shapes, prepare, time_updates

    shapes = Shapes(num_envs=args.num_envs, size=args.size)
    rows = []
    for agent in args.agents.split(","):
        for variant in args.variants.split(","):
            if variant not in VARIANTS:
                raise UsageError(f"--variants has '{variant}'. {did_you_mean(variant, VARIANTS)}")
            try:
                cfg = load_cfg_from_registry(args.task, agent_key(agent))
                apply_overrides({"agent": cfg}, args.overrides)
                cfg = prepare(cfg, variant, args.num_envs)
            except (TypeError, ValueError) as error:
                raise UsageError(str(error)) from error
            row: dict = {"agent": agent, "variant": variant, "num_envs": args.num_envs}
            try:
                row |= time_updates(cfg, shapes, device, args.repeats)
            except Exception as error:  # a compiler that is missing, or memory that is too small
                row["error"] = f"{type(error).__name__}: {' '.join(str(error).split())[:300]}"
            rows.append(row)
            print("  ".join(f"{name} {value}" for name, value in row.items()), flush=True)
    if args.json:
        print(json.dumps({"benchmark": "learner", "device": full_name(device), "size": args.size, "rows": rows}))
