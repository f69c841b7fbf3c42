#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Drives the robots with random, extreme and adversarial actions for a long time and looks for what must not happen.

No number may stop being finite, no world may have to be recovered, none may be changed by another world's reset, no
link may leave the lumen, and memory may not grow. Ends with status 1 if any of it happened. Findings are written as
JSON lines as they come; ``--resume`` goes on from such a file. Run for example::

    python scripts/benchmarks/soak.py --device cuda:0 --minutes 9 --out soak.jsonl --json
    python scripts/benchmarks/soak.py --device cuda:0 --minutes 9 --resume soak.jsonl --json
    python scripts/benchmarks/soak.py --device cpu --minutes 60
"""

from __future__ import annotations

import argparse
import gc
import json
import math
import statistics
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from _common import best_device, device_mib, forward_axis, full_name, host_mib, positive
from soak_checks.journal import Journal, Tally

from arcgym.rl import cli

ROBOTS = ("Capsule", "Magnetic", "Proximal")
GPU_STEPS, CPU_MINUTES = 1_000_000, 60.0
GPU_WORLDS, CPU_WORLDS = 1024, 8
READ_EVERY = 20
"""Control steps between two readings of the counters, which wait for the device."""

Row = dict[str, Any]


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="Any other argument is an override: env.sim.contact.friction=0.2 env.scene.colon.material=in_situ",
    )
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
    return parser


def names(text: str) -> list[str]:
    """Read names that commas separate, capitalised as in the names of tasks."""
    return [part.strip().capitalize() for part in text.split(",")]


def main() -> None:
    """Soak one task after the other and judge what was found."""
    parser = make_parser()
    args, overrides = cli.parse(parser)
    tasks = [f"ARC-{segment}-{robot}" for segment in args.segments for robot in args.robots]
    for task in tasks:
        load_cfg(parser, args, task, overrides)
    journal = open_journal(parser, args)
    args.device = args.device or best_device()
    on_cpu = args.device == "cpu"
    args.num_envs = args.num_envs or (CPU_WORLDS if on_cpu else GPU_WORLDS)
    args.minutes = args.minutes or (CPU_MINUTES if on_cpu and args.steps is None else math.inf)
    args.steps = args.steps or (sys.maxsize if on_cpu else GPU_STEPS)
    end = time.monotonic() + 60.0 * args.minutes
    for place, task in enumerate(tasks):
        now = time.monotonic()
        budget = Budget(
            args.steps // len(tasks) - journal.tally(task).env_steps, now + (end - now) / (len(tasks) - place)
        )
        if not budget.spent(0):
            soak(task, load_cfg(parser, args, task, overrides), budget, journal)
    sys.exit(report(tasks, journal, args))


def load_cfg(parser: argparse.ArgumentParser, args: argparse.Namespace, task: str, overrides: list[str]) -> Any:
    """Return a task's configuration; a mistake ends the script before anything is built.

    Episodes are not ended for lack of progress, so that a scope may be pushed against the wall for the whole of one.
    """
    choice = argparse.Namespace(task=task, agent="rsl_rl_cfg_entry_point", num_envs=args.num_envs, seed=args.seed)
    env_cfg, agent_cfg = cli.load_cfgs(parser, choice, overrides)
    if args.device is not None:
        cli.place(env_cfg, agent_cfg, args.device)
    env_cfg.terminations.stuck = None
    return env_cfg


def open_journal(parser: argparse.ArgumentParser, args: argparse.Namespace) -> Journal:
    """Return the file of findings, new or to be resumed."""
    if args.resume is None:
        if args.out.exists():
            parser.error(f"--out {args.out} exists; go on from it with --resume {args.out}, or name another file")
        return Journal(args.out)
    if not args.resume.is_file():
        parser.error(f"--resume {args.resume}: there is no such file")
    try:
        return Journal(args.resume)
    except ValueError as error:
        parser.error(f"--resume: {error}")


@dataclass
class Budget:
    """Control steps and time that a session of one task may take."""

    env_steps: int
    deadline: float

    def spent(self, env_steps: int) -> bool:
        """Whether so many control steps are enough, or time is up."""
        return env_steps >= self.env_steps or time.monotonic() >= self.deadline


def soak(task: str, env_cfg: Any, budget: Budget, journal: Journal) -> None:
    """Run one session of a task: checks, then adversarial steps until the budget is spent, then checks again."""
    import gymnasium as gym
    import torch
    from soak_checks.adversaries import Adversaries
    from soak_checks.watch import Watch

    env_cfg.seed += journal.sessions(task)
    journal.write("start", task, seed=env_cfg.seed, num_envs=env_cfg.scene.num_envs, device=env_cfg.sim.device)
    env: Any = gym.make(task, cfg=env_cfg).unwrapped
    env.reset()
    env.episode_length_buf = torch.randint_like(env.episode_length_buf, env.max_episode_length)
    adversaries = Adversaries(
        env.num_envs,
        env.action_manager.total_action_dim,
        forward_axis(env),
        env.step_dt,
        env.device,
        env_cfg.seed,
    )
    check_worlds(env, adversaries, journal, task)
    watch = Watch(env, adversaries.kind)
    with watch.guard.watch():
        step_on(env, adversaries, watch, budget, journal, task)
    check_worlds(env, adversaries, journal, task)
    env.close()
    gc.collect()


def step_on(env: Any, adversaries: Any, watch: Any, budget: Budget, journal: Journal, task: str) -> None:
    """Step the worlds and write what is found, until the budget is spent."""
    force, restarted = idle(env)
    memory: list[tuple[float, float]] = []
    done, start = 0, time.monotonic()
    while not budget.spent(done):
        for _ in range(READ_EVERY):
            obs, reward, terminated, truncated, extras = env.step(adversaries.act(force, restarted))
            watch.look(obs, reward, terminated, extras)
            force = env.scene["endoscope"].data.wall_force_peak.amax(dim=1)
            restarted = terminated | truncated
        now = time.monotonic()
        tally, events = watch.read(now - start)
        start, done = now, done + tally.env_steps
        memory.append((host_mib(), device_mib(env.device) or 0.0))
        for event in events:
            journal.write("event", task, seed=env.cfg.seed, **event)
        journal.write_part(task, tally)
        progress(task, journal.tally(task), tally, memory[-1])
    host, device = (growth([sample[k] for sample in memory]) for k in (0, 1))
    journal.write_part(task, Tally(host_growth_mib=host, device_growth_mib=device))


def idle(env: Any) -> tuple[Any, Any]:
    """Force and restarts before the first step: none."""
    import torch

    return torch.zeros(env.num_envs, device=env.device), torch.zeros(env.num_envs, dtype=torch.bool, device=env.device)


def growth(samples: list[float]) -> float:
    """Median of the last quarter of the samples less that of the second; 0 until there are eight."""
    quarter = len(samples) // 4
    if quarter < 2:
        return 0.0
    return statistics.median(samples[-quarter:]) - statistics.median(samples[quarter : 2 * quarter])


def check_worlds(env: Any, adversaries: Any, journal: Journal, task: str) -> None:
    """Check that a broken world is caught and that a reset leaves the others alone; write what is wrong."""
    from soak_checks.isolation import breakage_caught, neighbors_disturbed

    problems = [f"after a NaN in world 0: {problem}" for problem in breakage_caught(env)]
    disturbed = neighbors_disturbed(env, adversaries.act(*idle(env)))
    if disturbed:
        problems.append(f"a reset of world 0 changed the next step of {disturbed} other worlds")
    if problems:
        journal.write_part(task, Tally(problems=problems))


def progress(task: str, total: Tally, part: Tally, memory: tuple[float, float]) -> None:
    """Print one line on the state of things."""
    forces = max(total.largest["wall_force"].values())
    print(
        f"{task:24s}{total.env_steps:>10d} steps {part.env_steps / part.seconds:>8.1f}/s  {total.resets} resets  "
        f"{total.recovered_worlds} recovered  {total.pierced} pierced  {total.outside_links} links outside  "
        f"{sum(total.not_finite.values())} not finite  up to {forces:.1f} N  "
        f"host {memory[0]:.0f} MiB  device {memory[1]:.0f} MiB",
        flush=True,
    )


def report(tasks: list[str], journal: Journal, args: argparse.Namespace) -> int:
    """Print the findings of all sessions and return the exit status: 1 if any is a violation."""
    rows: list[Row] = []
    for task in tasks:
        tally = journal.tally(task)
        violations = tally.violations(args.growth_mib)
        if tally.env_steps == 0:
            violations.append("no step was made")
        rows.append({"task": task, **asdict(tally), "events": journal.events(task), "violations": violations})
        print(f"{task}: {tally.env_steps} steps, " + ("; ".join(violations) or "no violation"))
    ok = not any(row["violations"] for row in rows)
    if args.json:
        sessions = [line for line in journal.lines if line["kind"] == "start"]
        print(json.dumps({"device": full_name(args.device), "ok": ok, "sessions": sessions, "rows": rows}))
    return 0 if ok else 1


if __name__ == "__main__":
    main()
