# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Drive the robots with random, extreme and adversarial actions for a long time and look for what must not happen.

No number may stop being finite, no world may have to be recovered, none may be changed by another world's reset, no
link may leave the lumen, no contact may find no room or be missed (in samples of single worlds, whose links are
compared with all faces of the wall), and memory may not grow. Ends with status 1 if any of it happened. Findings are
written as JSON lines as they come; ``--resume`` goes on from such a file. Run for example::

    arcgym bench soak --device cuda:0 --minutes 9 --out soak.jsonl --json
    arcgym bench soak --device cuda:0 --minutes 9 --resume soak.jsonl --json
    arcgym bench soak --device cpu --minutes 60
    arcgym bench soak --device cpu --robots Proximal --num_envs 8 --steps 320 --json env.scene.colon.material=in_situ
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from pathlib import Path
from typing import Any

from arcgym.benchmarks.hardware import full_name
from arcgym.benchmarks.soak.journal import Journal
from arcgym.benchmarks.soak.report import findings
from arcgym.benchmarks.worlds import load_env_cfg
from arcgym.cli.arguments import positive
from arcgym.utils.errors import UsageError

TAKES_OVERRIDES = True
ROBOTS = ("Capsule", "Magnetic", "Proximal")
GPU_STEPS, CPU_MINUTES = 1_000_000, 60.0
"""Control steps of all tasks and worlds on a GPU, time for all tasks on a CPU [min], where none are given."""
GPU_WORLDS, CPU_WORLDS = 1024, 8
"""Worlds where none are given."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the tasks, how long they run and where the findings go."""
    parser.add_argument(
        "--robots", type=names, default=list(ROBOTS), help="robots (default: Capsule,Magnetic,Proximal)"
    )
    parser.add_argument("--segments", type=names, default=["Sigmoid"], help="segments of the tasks (default: Sigmoid)")
    parser.add_argument(
        "--num_envs",
        type=positive,
        help=f"worlds, 8 or more for all kinds of actions (GPU: {GPU_WORLDS}, CPU: {CPU_WORLDS})",
    )
    parser.add_argument("--steps", type=positive, help=f"control steps of all tasks and worlds (GPU: {GPU_STEPS})")
    parser.add_argument("--minutes", type=float, help=f"longest time, shared by the tasks (CPU: {CPU_MINUTES:g})")
    parser.add_argument("--device", help="cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first session (default: 0)")
    parser.add_argument("--growth_mib", type=float, default=128.0, help="largest growth of memory (default: 128)")
    parser.add_argument("--out", type=Path, default=Path("logs/soak.jsonl"), help="new file of findings, JSON lines")
    parser.add_argument("--resume", type=Path, help="go on from this file of findings, with the next seed")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object on the last line")


def names(text: str) -> list[str]:
    """Read names that commas separate, capitalized as in the names of tasks."""
    return [part.strip().capitalize() for part in text.split(",")]


def run(args: argparse.Namespace) -> int:
    """Soak one task after the other, judge what was found and return 1 if any of it is a violation."""
    tasks = [f"ARC-{segment}-{robot}" for segment in args.segments for robot in args.robots]
    cfgs = [task_cfg(task, args) for task in tasks]

    from arcgym.rl.device import choose_device
    from arcgym.rl.preflight import check_environment

    for cfg in cfgs:
        check_environment(cfg, args.device, outputs=[args.resume or args.out])
    args.device = choose_device(args.device)
    journal = open_journal(args.out, args.resume)
    on_cpu = args.device == "cpu"
    args.num_envs = args.num_envs or (CPU_WORLDS if on_cpu else GPU_WORLDS)
    args.minutes = args.minutes or (CPU_MINUTES if on_cpu and args.steps is None else math.inf)
    args.steps = args.steps or (sys.maxsize if on_cpu else GPU_STEPS)
    soak_all(tasks, args, journal)
    return report(tasks, args, journal)


def soak_all(tasks: list[str], args: argparse.Namespace, journal: Journal) -> None:
    """Share steps and time between the tasks and soak each."""
    from arcgym.benchmarks.soak import session

    end = time.monotonic() + 60.0 * args.minutes
    for place, task in enumerate(tasks):
        now = time.monotonic()
        steps = args.steps // len(tasks) - journal.tally(task).env_steps
        budget = session.Budget(steps, now + (end - now) / (len(tasks) - place))
        if not budget.spent(0):
            session.soak(task, task_cfg(task, args), budget, journal)


def task_cfg(task: str, args: argparse.Namespace) -> Any:
    """Return a task's configuration.

    Episodes are not ended for lack of progress, so that a scope may be pushed against the wall for the whole of one.
    """
    cfg = load_env_cfg(task, args.overrides, args.seed, args.num_envs, args.device)
    cfg.terminations.stuck = None
    return cfg


def open_journal(out: Path, resume: Path | None) -> Journal:
    """Return the file of findings, new or to be resumed."""
    if resume is None:
        if out.exists():
            raise UsageError(f"--out {out} exists; go on from it with --resume {out}, or name another file")
        return Journal(out)
    if not resume.is_file():
        raise UsageError(f"--resume {resume}: there is no such file")
    try:
        return Journal(resume)
    except ValueError as error:
        raise UsageError(f"--resume: {error}") from error


def report(tasks: list[str], args: argparse.Namespace, journal: Journal) -> int:
    """Print the findings of all sessions and return the exit status: 1 if any is a violation."""
    rows = findings(tasks, journal, args.growth_mib)
    for row in rows:
        print(f"{row['task']}: {row['env_steps']} steps, " + ("; ".join(row["violations"]) or "no violation"))
    ok = not any(row["violations"] for row in rows)
    if args.json:
        sessions = [line for line in journal.lines if line["kind"] == "start"]
        print(json.dumps({"device": full_name(args.device), "ok": ok, "sessions": sessions, "rows": rows}))
    return 0 if ok else 1
