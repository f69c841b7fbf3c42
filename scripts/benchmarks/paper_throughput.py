#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measure what the paper's table of throughput measures: PPO from images with 1 and 5 worlds, for 44 000 transitions.

A control step is 1/120 s (two physics steps of 1/240 s, in the paper as here), an observation five color
pictures of 84×84 pixels. Prints the control steps per second while collecting and in all, beside the paper's. A run
that is cut short by ``--transitions`` or ``--minutes`` says so. Run for example::

    python scripts/benchmarks/paper_throughput.py --device cuda:0 --num_envs 5 --minutes 9 --json
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from typing import Any

from arcgym.benchmarks.hardware import full_name
from arcgym.benchmarks.paper import CONTROL_DT, EPISODE_S, PAPER_RATE, PAPER_TRANSITIONS
from arcgym.cli.arguments import counts, positive
from arcgym.cli.parser import CommandParser
from arcgym.utils.errors import UsageError

HEADINGS = ("worlds", "transitions", "wall s", "collect s", "learn s", "collect steps/s", "steps/s", "paper", "factor")

Row = dict[str, Any]


def make_parser() -> CommandParser:
    """Return the parser of the command line."""
    parser = CommandParser("paper_throughput.py", __doc__, takes_overrides=True)
    parser.add_argument("--task", default="ARC-Sigmoid-Proximal", help="task name (default: ARC-Sigmoid-Proximal)")
    parser.add_argument("--num_envs", type=counts, default=[1, 5], help="numbers of worlds (default: 1,5)")
    parser.add_argument("--transitions", type=positive, default=PAPER_TRANSITIONS, help="transitions (default: 44000)")
    parser.add_argument("--minutes", type=float, default=math.inf, help="time after which no new rollout is begun")
    parser.add_argument("--rollout", type=positive, default=2048, help="steps of each world in a rollout (2048)")
    parser.add_argument("--batch", type=positive, default=1024, help="transitions of a mini-batch (default: 1024)")
    parser.add_argument("--epochs", type=positive, default=64, help="passes over a rollout (default: 64)")
    parser.add_argument("--device", help="cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)")
    parser.add_argument("--seed", type=int, default=0, help="seed of environment and networks (default: 0)")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object on the last line")
    return parser


def main() -> None:
    """Train once for every number of worlds and print the rows."""
    parser = make_parser()
    args = parser.parse(sys.argv[1:])
    try:
        check(args)
    except UsageError as error:
        parser.error(str(error))
    end = time.monotonic() + 60.0 * args.minutes
    rows = []
    for place, num_envs in enumerate(args.num_envs):
        env_cfg, agent_cfg = load_cfgs(args, num_envs)
        now = time.monotonic()
        deadline = now + (end - now) / (len(args.num_envs) - place)
        rows.append(measure(args, env_cfg, agent_cfg, deadline))
    print("".join(f"{heading:>16s}" for heading in HEADINGS))
    for row in rows:
        print(describe(row))
    if args.json:
        report = {"device": full_name(args.device), "task": args.task, "settings": settings(args), "rows": rows}
        print(json.dumps(report))


def check(args: argparse.Namespace) -> None:
    """Find mistakes before anything is built, and choose the device.

    Raises:
        UsageError: If there is one.
    """
    least = min(args.num_envs)
    if args.rollout * least < args.batch:
        raise UsageError(f"--batch {args.batch} is more than a rollout of {args.rollout} steps in {least} worlds")
    env_cfg, agent_cfg = load_cfgs(args, least)

    from arcgym.rl.device import choose_device
    from arcgym.rl.preflight import check_run

    check_run(env_cfg, agent_cfg, args.device, trains=True)
    args.device = choose_device(args.device)


def settings(args: argparse.Namespace) -> dict[str, float]:
    """Return the figures of PPO and of the step, for the record."""
    return {"rollout": args.rollout, "batch": args.batch, "epochs": args.epochs, "control_dt": CONTROL_DT}


def load_cfgs(args: argparse.Namespace, num_envs: int) -> tuple[Any, Any]:
    """Return the task's configurations with the paper's clock and figures of PPO; overrides come last.

    Raises:
        UsageError: If the task or an override is wrong.
    """
    from arcgym.utils.hydra import apply_overrides
    from arcgym.utils.registry import load_cfg_from_registry

    try:
        env_cfg = load_cfg_from_registry(args.task, "env_cfg_entry_point")
        agent_cfg = load_cfg_from_registry(args.task, "rsl_rl_cfg_entry_point")
        env_cfg.scene.num_envs, agent_cfg.seed = num_envs, args.seed
        follow_paper(env_cfg, agent_cfg, args, num_envs)
        apply_overrides({"env": env_cfg, "agent": agent_cfg}, args.overrides)
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error
    return env_cfg, agent_cfg


def follow_paper(env_cfg: Any, agent_cfg: Any, args: argparse.Namespace, num_envs: int) -> None:
    """Write the paper's figures: one encoder for actor and critic, which both see the pictures alone."""
    from arcgym.rl import GaussianDistributionCfg, RslRlCnnModelCfg, RslRlPpoAlgorithmCfg

    env_cfg.decimation = round(CONTROL_DT / env_cfg.sim.dt)
    env_cfg.episode_length_s = EPISODE_S
    agent_cfg.num_steps_per_env = args.rollout
    agent_cfg.obs_groups = {"actor": ["policy"], "critic": ["policy"]}
    agent_cfg.actor = RslRlCnnModelCfg(hidden_dims=[512], distribution_cfg=GaussianDistributionCfg())
    agent_cfg.critic = RslRlCnnModelCfg(hidden_dims=[512])
    agent_cfg.algorithm = RslRlPpoAlgorithmCfg(
        num_learning_epochs=args.epochs,
        num_mini_batches=max(1, round(args.rollout * num_envs / args.batch)),
        learning_rate=1.0e-4,
        schedule="fixed",
        gamma=0.99,
        lam=0.95,
        clip_param=0.2,
        entropy_coef=0.1,
        share_cnn_encoders=True,
    )


def measure(args: argparse.Namespace, env_cfg: Any, agent_cfg: Any, deadline: float) -> Row:
    """Train for a number of transitions, in whole rollouts, or until the deadline; return the row."""
    from arcgym.rl import place

    place(env_cfg, agent_cfg, args.device)
    env, build_s = build(args.task, env_cfg, agent_cfg)
    runner, learning = timed_runner(env, agent_cfg, env_cfg.sim.device)
    rollout = agent_cfg.num_steps_per_env * env.num_envs
    done, start = 0, time.perf_counter()
    while done < args.transitions and (done == 0 or time.monotonic() < deadline):
        runner.learn(1, init_at_random_ep_len=done == 0)
        done += rollout
        print(f"{env.num_envs} worlds: {done} transitions after {time.perf_counter() - start:.1f} s", flush=True)
    row = figures(env.num_envs, done, time.perf_counter() - start, sum(learning))
    env.close()
    return {**row, "build_s": build_s, "world_failures": env.unwrapped.world_failures}


def build(task: str, env_cfg: Any, agent_cfg: Any) -> tuple[Any, float]:
    """Return the environment as rsl_rl sees it, and the time until its first steps are made [s]."""
    import torch

    from arcgym.rl import make_env

    start = time.perf_counter()
    env = make_env(task, env_cfg, agent_cfg)
    for _ in range(3):
        env.step(torch.zeros(env.num_envs, env.num_actions, device=env.device))
    return env, time.perf_counter() - start


def timed_runner(env: Any, agent_cfg: Any, device: str) -> tuple[Any, list[float]]:
    """Return a runner without logs, and the list to which it adds the duration of each update [s]."""
    from rsl_rl.utils import resolve_callable

    from arcgym.benchmarks.timing import time_ms

    runner: Any = resolve_callable(agent_cfg.class_name)(env, agent_cfg.to_dict(), log_dir=None, device=device)
    update, durations = runner.alg.update, []

    def timed_update() -> Any:
        losses = []
        durations.append(1.0e-3 * time_ms(lambda: losses.append(update()), device))
        return losses[0]

    runner.alg.update = timed_update
    return runner, durations


def figures(num_envs: int, transitions: int, wall_s: float, learn_s: float) -> Row:
    """Return the row of a run, with the time that 44 000 transitions take, measured or extrapolated."""
    rate, paper = transitions / wall_s, PAPER_RATE.get(num_envs)
    return {
        "num_envs": num_envs,
        "transitions": transitions,
        "wall_s": wall_s,
        "collect_s": wall_s - learn_s,
        "learn_s": learn_s,
        "collect_env_steps_per_s": transitions / (wall_s - learn_s),
        "env_steps_per_s": rate,
        "sim_s_per_wall_s": rate * CONTROL_DT,
        "wall_s_44000": PAPER_TRANSITIONS / rate,
        "extrapolated": transitions < PAPER_TRANSITIONS,
        "paper_env_steps_per_s": paper,
        "factor": None if paper is None else rate / paper,
    }


def describe(row: Row) -> str:
    """Return one line of the table, and one on 44 000 transitions."""
    keys = ("num_envs", "transitions", "wall_s", "collect_s", "learn_s", "collect_env_steps_per_s", "env_steps_per_s")
    cells = [f"{row[key]:.1f}" if isinstance(row[key], float) else str(row[key]) for key in keys]
    paper = ["-", "-"] if row["factor"] is None else [f"{row['paper_env_steps_per_s']:.2f}", f"{row['factor']:.1f}"]
    how = "EXTRAPOLATED from this shorter run" if row["extrapolated"] else "at the rate measured"
    line = "".join(f"{cell:>16s}" for cell in [*cells, *paper])
    return f"{line}\n{'':16s}{PAPER_TRANSITIONS} transitions: {row['wall_s_44000']:.0f} s, {how}"


if __name__ == "__main__":
    main()
