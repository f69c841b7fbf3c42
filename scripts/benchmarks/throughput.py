#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how fast a task runs: physics, 84-pixel colour and depth, rewards and resets, under random actions.

The tip is at the end of the segment when timing begins, so that the shaft fills it and lies against the wall. Every
number of worlds runs in a process of its own, so that its memory is measured clean; one that does not fit gives a row
with an error, and the others go on. Run for example::

    python scripts/benchmarks/throughput.py --num_envs 1,64,1024 --device cuda:0 --stages --cold --bandwidth --json
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from typing import Any

from _common import advance, best_device, counts, device_mib, forward_axis, peak_host_mib, time_ms
from rich.console import Console
from rich.table import Table

from arcgym.rl import cli

GPU_COUNTS, CPU_COUNTS = [1, 16, 64, 256, 1024, 4096], [1, 4]
WARM_UP = 3
"""Control steps before the timed ones: the first compiles and captures, the others settle the contacts."""
BEFORE_END = 0.03
"""Way to the end of the segment that the tip has before it when timing begins [m], so that few worlds succeed."""
MOST_WITHDRAWING = 60
"""Control steps after which a tip that does not come back is left where it is."""
MODULE_LOADED = re.compile(r"^ *Module (\S+) .* took ([\d.]+) ms +\((compiled|cached)\)", re.MULTILINE)
"""What Warp prints when it has loaded a module of kernels."""

COLUMNS = {
    "num_envs": ("worlds", "{}"),
    "env_steps_per_s": ("env steps/s", "{:.1f}"),
    "sim_s_per_wall_s": ("sim s/wall s", "{:.2f}"),
    "total": ("ms/step", "{:.2f}"),
    "device_mib": ("device MiB", "{:.0f}"),
    "host_mib": ("host MiB", "{:.0f}"),
    "links_touching": ("touching", "{:.1f}"),
    "compile_s": ("compile s", "{:.1f}"),
    "first_step_s": ("first step s", "{:.1f}"),
}
"""Heading and format of each figure of a row."""

STARTED = time.perf_counter()
"""When this script began [s]."""

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
    parser.add_argument("--start", choices=("end", "entry"), default="end", help="where in the segment the tip is")
    parser.add_argument("--stages", action="store_true", help="time each part of a control step alone, too")
    parser.add_argument("--bandwidth", action="store_true", help="estimate memory traffic beside a measured copy's")
    parser.add_argument("--cold", action="store_true", help="use a fresh kernel cache, and start once more to fill it")
    parser.add_argument("--repeats", type=int, default=7, help="timed calls of each stage (default: 7)")
    parser.add_argument("--seed", type=int, default=0, help="seed of environment and actions (default: 0)")
    parser.add_argument("--timeout", type=float, default=1800.0, help="longest run of one number of worlds [s]")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object on the last line")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    return parser


def main() -> None:
    """Measure one number of worlds as a worker, or start a worker for each."""
    parser = make_parser()
    args, overrides = cli.parse(parser)
    if args.worker:
        print(json.dumps(measure(args, load_cfg(parser, args, overrides))))
        return
    load_cfg(parser, args, overrides)
    args.device = args.device or best_device()
    args.num_envs = args.num_envs or (CPU_COUNTS if args.device == "cpu" else GPU_COUNTS)
    console = Console()
    console.print(f"{args.task} on {args.device}, median of {args.steps} control steps", highlight=False)
    print("".join(f"{heading:>14s}" for heading, _ in COLUMNS.values()), flush=True)
    with tempfile.TemporaryDirectory() as cache:
        rows = run_all(args, overrides, fresh_cache(cache) if args.cold else {})
    if args.stages:
        console.print(stage_table(rows))
    if args.json:
        print(json.dumps({"device": device_name(rows, args.device), "task": args.task, "rows": rows}))


def run_all(args: argparse.Namespace, overrides: list[str], environment: dict[str, str]) -> list[Row]:
    """Measure every number of worlds; with a fresh cache the first is started twice, cold and cached."""
    cold = run_worker(args, args.num_envs[0], overrides, environment) if args.cold else {}
    rows = []
    for num_envs in args.num_envs:
        row = run_worker(args, num_envs, overrides, environment)
        if args.cold and not rows:
            row |= {f"{name}_cold": cold[name] for name in ("compile_s", "first_step_s") if name in cold}
        rows.append(row)
        print(describe(row), flush=True)
    return rows


def fresh_cache(folder: str) -> dict[str, str]:
    """Environment variables with which Warp and the driver keep their kernels in a folder."""
    return {"WARP_CACHE_PATH": os.path.join(folder, "warp"), "CUDA_CACHE_PATH": os.path.join(folder, "cuda")}


def load_cfg(parser: argparse.ArgumentParser, args: argparse.Namespace, overrides: list[str]) -> Any:
    """Return the task's configuration with the overrides; a mistake ends the script before anything is built."""
    choice = argparse.Namespace(task=args.task, agent="rsl_rl_cfg_entry_point", num_envs=None, seed=args.seed)
    env_cfg, agent_cfg = cli.load_cfgs(parser, choice, overrides)
    if args.worker:
        env_cfg.scene.num_envs = args.num_envs[0]
        cli.place(env_cfg, agent_cfg, args.device)
    return env_cfg


def run_worker(
    args: argparse.Namespace, num_envs: int, overrides: list[str], environment: dict[str, str] | None = None
) -> Row:
    """Measure one number of worlds in a process of its own; what goes wrong there becomes the row's ``error``."""
    command = [sys.executable, __file__, "--worker", "--num_envs", str(num_envs)]
    command += [f"--{name}={getattr(args, name)}" for name in ("task", "device", "steps", "repeats", "seed", "start")]
    command += [f"--{name}" for name in ("stages", "bandwidth") if getattr(args, name)]
    settings = {"capture_output": True, "text": True, "env": {**os.environ, **(environment or {})}}
    try:
        result = subprocess.run([*command, *overrides], timeout=args.timeout, **settings)
    except subprocess.TimeoutExpired:
        return {"num_envs": num_envs, "error": f"not finished after {args.timeout:g} s"}
    if result.returncode == 0:
        return json.loads(result.stdout.splitlines()[-1]) | module_loads(result.stdout)
    lines = result.stderr.strip().splitlines() or ["no message"]
    killed = f"ended by signal {-result.returncode}, perhaps for lack of memory: " if result.returncode < 0 else ""
    return {"num_envs": num_envs, "error": killed + lines[-1]}


def module_loads(output: str) -> Row:
    """Time that a worker spent on compiling and loading modules of kernels [s], and those that it had to compile."""
    loads = MODULE_LOADED.findall(output)
    compiled = [name for name, _, how in loads if how == "compiled"]
    return {"compile_s": 1.0e-3 * sum(float(ms) for _, ms, _ in loads), "compiled_modules": compiled}


def measure(args: argparse.Namespace, env_cfg: Any) -> Row:
    """Build the environment, step it under random actions and return the row."""
    import torch

    device, num_envs = env_cfg.sim.device, env_cfg.scene.num_envs
    env, used_before = build(args.task, env_cfg)
    shape = (num_envs, env.action_manager.total_action_dim)

    def step() -> None:
        env.step(2.0 * torch.rand(shape, device=device) - 1.0)

    step()
    first_step_s = time.perf_counter() - STARTED
    if args.start == "end":
        fill_segment(env)
    for _ in range(WARM_UP):
        step()
    durations = [time_ms(step, device) for _ in range(args.steps)]
    total = statistics.median(durations)
    row = {
        "num_envs": num_envs,
        "env_steps_per_s": 1.0e3 * num_envs / total,
        "sim_s_per_wall_s": 1.0e3 * num_envs * env.step_dt / total,
        "ms": {"total": total},
        "mean_step_ms": statistics.fmean(durations),
        "device_mib": None if used_before is None else (device_mib(device) or 0.0) - used_before,
        "host_mib": peak_host_mib(),
        "first_step_s": first_step_s,
        "world_failures": env.world_failures,
        **situation(env),
    }
    add_details(row, env, args)
    env.close()
    return row


def build(task: str, env_cfg: Any) -> tuple[Any, float | None]:
    """Return the environment after its first reset, and the device memory in use before [MiB]."""
    import gymnasium as gym
    import torch
    import warp as wp

    from arcgym.utils import warp_setup  # noqa: F401  sets the log level that the next line changes

    wp.config.log_level = wp.LOG_INFO
    wp.init()
    used_before = device_mib(env_cfg.sim.device)
    env: Any = gym.make(task, cfg=env_cfg).unwrapped
    env.reset()
    # Resets then come evenly, as in training, and not in all worlds at once.
    env.episode_length_buf = torch.randint_like(env.episode_length_buf, env.max_episode_length)
    return env, used_before


def fill_segment(env: Any) -> None:
    """Put every world into the start state of the next segment and withdraw the tip into the task's."""
    import torch

    snapshots = env.sim.snapshots
    following = snapshots.names[snapshots.index(env.cfg.segment) + 1 :]
    if not following:
        sys.exit(f"{env.cfg.segment} is the last segment with a start state; take --start entry")
    _, end = env.scene["colon"].stage.segment_bounds()[env.cfg.segment]
    env.sim.write_snapshot(snapshots.index(following[0]))
    env.sim.forward()
    actions = torch.zeros(env.num_envs, env.action_manager.total_action_dim, device=env.device)
    actions[:, forward_axis(env)] = -1.0
    for _ in range(MOST_WITHDRAWING):
        advance(env, actions)
        if float(env.scene["endoscope"].data.tip_arc_length.max()) < end - BEFORE_END:
            return


def situation(env: Any) -> Row:
    """Device, and where the scopes are at the end of the timed steps: means over the worlds."""
    import warp as wp

    data = env.scene["endoscope"].data
    return {
        "device_name": wp.get_device(env.device).name,
        "tip_arc_m": data.tip_arc_length.mean().item(),
        "inserted_m": data.inserted_length.mean().item(),
        "links_touching": (data.wall_force_peak > 0.0).float().sum(dim=1).mean().item(),
    }


def add_details(row: Row, env: Any, args: argparse.Namespace) -> None:
    """Add the stages and the memory traffic to a row, as far as wished."""
    import torch

    if not (args.stages or args.bandwidth):
        return
    from _stages import time_stages
    from _traffic import traffic

    actions = 2.0 * torch.rand(env.num_envs, env.action_manager.total_action_dim, device=env.device) - 1.0
    row["ms"].update(time_stages(env, actions, args.repeats))
    if args.bandwidth:
        row["bandwidth"] = traffic(env.sim, env.cfg.decimation, row["ms"]["physics"])


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
