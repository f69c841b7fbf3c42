#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how fast a task runs: physics, 84-pixel colour and depth, rewards and resets, under random actions.

Every number of worlds runs in a process of its own, so that its memory is measured clean; one that does not fit gives a
row with an error, and the others go on. Run for example::

    python scripts/benchmarks/throughput.py --num_envs 1,64,1024 --device cuda:0 --stages --json
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import subprocess
import sys
import time
from typing import Any

from _common import time_ms
from rich.console import Console
from rich.table import Table

from arcgym.rl import cli

GPU_COUNTS, CPU_COUNTS = [1, 16, 64, 256, 1024, 4096], [1, 4]
WARM_UP = 3
"""Control steps before the timed ones: the first compiles and captures, the others settle the contacts."""

COLUMNS = {
    "num_envs": ("worlds", "{}"),
    "env_steps_per_s": ("env steps/s", "{:.1f}"),
    "sim_s_per_wall_s": ("sim s/wall s", "{:.2f}"),
    "total": ("ms/step", "{:.2f}"),
    "device_mib": ("device MiB", "{:.0f}"),
    "host_mib": ("host MiB", "{:.0f}"),
    "build_s": ("build s", "{:.1f}"),
    "compile_s": ("compile s", "{:.1f}"),
}
"""Heading and format of each figure of a row."""

Row = dict[str, Any]
"""Figures of one number of worlds, or ``num_envs`` and ``error``."""


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="Any other argument is an override: env.sim.contact.friction=0.2 env.scene.camera.width=128",
    )
    parser.add_argument("--task", default="ARC-Sigmoid-Proximal", help="task name; scripts/list_envs.py lists them")
    parser.add_argument("--num_envs", type=counts, help="numbers of worlds (default: 1,16,64,256,1024,4096; CPU: 1,4)")
    parser.add_argument("--steps", type=int, default=20, help="timed control steps; the median counts (default: 20)")
    parser.add_argument("--device", help="cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)")
    parser.add_argument("--stages", action="store_true", help="time each part of a control step alone, too")
    parser.add_argument("--repeats", type=int, default=7, help="timed calls of each stage (default: 7)")
    parser.add_argument("--seed", type=int, default=0, help="seed of environment and actions (default: 0)")
    parser.add_argument("--timeout", type=float, default=1800.0, help="longest run of one number of worlds [s]")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object on the last line")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    return parser


def counts(text: str) -> list[int]:
    """Read numbers of worlds that commas separate."""
    numbers = [int(part) for part in text.split(",")]
    if min(numbers) < 1:
        raise argparse.ArgumentTypeError(f"{text!r}: every number of worlds must be at least 1")
    return numbers


def main() -> None:
    """Measure one number of worlds as a worker, or start a worker for each."""
    parser = make_parser()
    args, overrides = cli.parse(parser)
    if args.worker:
        print(json.dumps(measure(args, load_cfg(parser, args, overrides))))
        return
    load_cfg(parser, args, overrides)
    args.device = args.device or best_device()
    console, rows = Console(), []
    numbers = args.num_envs or (CPU_COUNTS if args.device == "cpu" else GPU_COUNTS)
    console.print(f"{args.task} on {args.device}, median of {args.steps} control steps", highlight=False)
    print("".join(f"{heading:>14s}" for heading, _ in COLUMNS.values()), flush=True)
    for num_envs in numbers:
        rows.append(run_worker(args, num_envs, overrides))
        print(describe(rows[-1]), flush=True)
    if args.stages:
        console.print(stage_table(rows))
    if args.json:
        print(json.dumps({"device": device_name(rows, args.device), "task": args.task, "rows": rows}))


def best_device() -> str:
    """First GPU, or the CPU where there is none."""
    import torch

    return "cuda:0" if torch.cuda.is_available() else "cpu"


def load_cfg(parser: argparse.ArgumentParser, args: argparse.Namespace, overrides: list[str]) -> Any:
    """Return the task's configuration with the overrides; a mistake ends the script before anything is built."""
    choice = argparse.Namespace(task=args.task, agent="rsl_rl_cfg_entry_point", num_envs=None, seed=args.seed)
    env_cfg, agent_cfg = cli.load_cfgs(parser, choice, overrides)
    if args.worker:
        env_cfg.scene.num_envs = args.num_envs[0]
        cli.place(env_cfg, agent_cfg, args.device)
    return env_cfg


def run_worker(args: argparse.Namespace, num_envs: int, overrides: list[str]) -> Row:
    """Measure one number of worlds in a process of its own; what goes wrong there becomes the row's ``error``."""
    command = [sys.executable, __file__, "--worker", "--num_envs", str(num_envs)]
    command += [f"--{name}={getattr(args, name)}" for name in ("task", "device", "steps", "repeats", "seed")]
    command += ["--stages"] if args.stages else []
    try:
        result = subprocess.run([*command, *overrides], capture_output=True, text=True, timeout=args.timeout)
    except subprocess.TimeoutExpired:
        return {"num_envs": num_envs, "error": f"not finished after {args.timeout:g} s"}
    if result.returncode == 0:
        return json.loads(result.stdout.splitlines()[-1])
    lines = result.stderr.strip().splitlines() or ["no message"]
    killed = f"ended by signal {-result.returncode}, perhaps for lack of memory: " if result.returncode < 0 else ""
    return {"num_envs": num_envs, "error": killed + lines[-1]}


def measure(args: argparse.Namespace, env_cfg: Any) -> Row:
    """Build the environment, step it under random actions and return the row."""
    import gymnasium as gym
    import torch
    import warp as wp

    wp.init()
    device, num_envs = env_cfg.sim.device, env_cfg.scene.num_envs
    used_before, start = device_mib(device), time.perf_counter()
    env: Any = gym.make(args.task, cfg=env_cfg).unwrapped
    env.reset()
    build_s = time.perf_counter() - start
    # Resets then come evenly, as in training, and not in all worlds at once.
    env.episode_length_buf = torch.randint_like(env.episode_length_buf, env.max_episode_length)
    shape = (num_envs, env.action_manager.total_action_dim)

    def step() -> None:
        env.step(2.0 * torch.rand(shape, device=device) - 1.0)

    first, *_ = [time_ms(step, device) for _ in range(WARM_UP)]
    durations = [time_ms(step, device) for _ in range(args.steps)]
    total = statistics.median(durations)
    row = {
        "num_envs": num_envs,
        "env_steps_per_s": 1.0e3 * num_envs / total,
        "sim_s_per_wall_s": 1.0e3 * num_envs * env.step_dt / total,
        "ms": {"total": total},
        "mean_step_ms": statistics.fmean(durations),
        "device_mib": None if used_before is None else (device_mib(device) or 0.0) - used_before,
        "host_mib": host_mib(),
        "compile_s": max(0.0, 1.0e-3 * (first - total)),
        "build_s": build_s,
        "world_failures": env.world_failures,
        "device_name": wp.get_device(device).name,
    }
    if args.stages:
        from _stages import time_stages

        row["ms"].update(time_stages(env, 2.0 * torch.rand(shape, device=device) - 1.0, args.repeats))
    env.close()
    return row


def device_mib(device: str) -> float | None:
    """Memory in use on a GPU, by whatever program [MiB]; None on the CPU."""
    import warp as wp

    if not device.startswith("cuda"):
        return None
    wp.synchronize_device(device)
    found = wp.get_device(device)
    return (found.total_memory - found.free_memory) / 2**20


def host_mib() -> float:
    """Largest resident memory of this process so far [MiB]."""
    unit = 2**20 if sys.platform == "darwin" else 2**10
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def device_name(rows: list[Row], device: str) -> str:
    """Device, with the hardware's name if a worker came far enough to tell."""
    names = [row["device_name"] for row in rows if "device_name" in row]
    return f"{device} ({names[0]})" if names else device


def describe(row: Row) -> str:
    """Return one line of the table of results."""
    if "error" in row:
        return f"{row['num_envs']:>14d}  {row['error']}"
    values = {**row, **row["ms"]}
    cells = ["-" if values[key] is None else form.format(values[key]) for key, (_, form) in COLUMNS.items()]
    return "".join(f"{cell:>14s}" for cell in cells)


def stage_table(rows: list[Row]) -> Table:
    """Return milliseconds a control step, one line a stage and one column a number of worlds."""
    from _stages import STAGES

    done = [row for row in rows if "error" not in row]
    table = Table("stage", "what", title="ms per control step")
    for row in done:
        table.add_column(f"N = {row['num_envs']}", justify="right")
    for name, what in {"total": "env.step, from the loop", **STAGES}.items():
        if any(name in row["ms"] for row in done):
            table.add_row(name, what, *(f"{row['ms'].get(name, float('nan')):.3f}" for row in done))
    return table


if __name__ == "__main__":
    main()
