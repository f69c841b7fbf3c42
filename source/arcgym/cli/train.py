# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Train a policy with rsl_rl.

    arcgym train --task ARC-Splenic-Proximal --num_envs 64 --max_iterations 300

The run goes to logs/rsl_rl/<experiment>/<time>[_<run name>]. Ctrl-C or a kill leaves a checkpoint there; go on with
--resume, which starts from that run's configurations and writes the command line's changes on top.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.cli.arguments import FilmedRunArguments, add_fields, argument, positive, read_fields
from arcgym.cli.stopping import stopped_cleanly
from arcgym.cli.task import agent_key, load_cfgs, load_run_cfgs, refuse_run, with_trained_agent
from arcgym.utils.errors import UsageError

TAKES_OVERRIDES = True


@dataclass(frozen=True, kw_only=True)
class TrainArguments(FilmedRunArguments):
    """Arguments of ``arcgym train``."""

    max_iterations: int | None = argument("updates to run, on top of those of a resumed run", None, type=positive)
    max_minutes: float | None = argument("minutes of learning, those of a resumed run included", None, type=float)
    log_dir: str | None = argument("folder of this run (default: logs/rsl_rl/<experiment>/<time>)", None)
    evaluate: bool = argument("run each world's first episode when learning has ended", False)
    run_name: str | None = argument("suffix of the run's folder", None)
    resume: bool = argument("go on from a checkpoint (--load_run, --checkpoint)", False)
    logger: str | None = argument("where curves go", None, choices=("tensorboard", "wandb", "neptune"))
    log_project_name: str | None = argument("project for wandb and neptune", None)
    distributed: bool = argument("one process a GPU, started by torchrun", False)
    video_interval: int = argument("control steps between videos (default: 2000)", 2000, type=positive, group="video")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_fields(parser, TrainArguments)


def run(namespace: argparse.Namespace) -> int:
    """Train, and return the exit status: 0, or 128 and the signal's number after Ctrl-C or a kill."""
    args = read_fields(TrainArguments, namespace)
    checkpoint = None
    env_cfg, agent_cfg = load_cfgs(args)
    if agent_cfg.resume:
        args = with_trained_agent(args)
        env_cfg, agent_cfg, checkpoint = load_run_cfgs(args)
        _refuse_another_start(agent_cfg, checkpoint)
    else:
        refuse_run(args, "without --resume: it goes on from a run; agent.init_policy=PATH takes a policy alone")

    from arcgym.rl.training import TrainOptions, train

    interval = args.video_interval if args.video else None
    folder = Path(args.log_dir) if args.log_dir else None
    options = TrainOptions(
        device=args.device,
        distributed=args.distributed,
        checkpoint=checkpoint,
        video_interval=interval,
        video_length=args.video_length,
        folder=folder,
        evaluates=args.evaluate,
        agent=agent_key(args.agent),
    )
    with stopped_cleanly("before the first update; nothing is left"):
        return train(args.task, env_cfg, agent_cfg, options)


def _refuse_another_start(agent_cfg: Any, checkpoint: Path) -> None:
    """Raise if a resumed run is to have begun with another policy or teacher, which it would not load any more."""
    from arcgym.rl.params import BEGUN_FROM, read_params

    saved = read_params(checkpoint.parent)
    if saved is None:
        return
    for name in BEGUN_FROM:
        then, now = saved.agent.get(name) or None, getattr(agent_cfg, name, None) or None
        if then != now:
            raise UsageError(
                f"agent.{name} is {now} with --resume, and the run began with {then}: a run that goes on loads neither "
                "again. Leave it out, or start a new run."
            )
