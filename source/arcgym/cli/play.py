# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Run a trained policy, record it and export it.

    arcgym play --task ARC-Splenic-Proximal --video --record logs/episodes

Uses the -Play variant of the task with the run's own configurations; the command line's changes come on top and are
printed. It ends when each world's first episode has ended: these are the episodes that the success rate counts. The
video goes to videos/play of the run, the policy to exported. --policy zero, random and expert need no checkpoint; the
scripted expert sees the centerline. --record writes every episode's trajectory to a file.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

from arcgym.cli.arguments import RunArguments, add_fields, argument, positive, read_fields
from arcgym.cli.task import PLAY, load_cfgs, load_run_cfgs

TAKES_OVERRIDES = True


@dataclass(frozen=True, kw_only=True)
class PlayArguments(RunArguments):
    """Arguments of ``arcgym play``."""

    policy: str = argument(
        "source of the actions (default: trained)", "trained", choices=("trained", "zero", "random", "expert")
    )
    steps: int | None = argument(
        "control steps (default: until each world's first episode has ended)", None, type=positive
    )
    record: str | None = argument("record trajectories: a folder, or a file ending in .hdf5", None, metavar="PATH")
    observations: bool = argument("record what the policy observes too, for imitation", False)
    json: bool = argument("print the figures as JSON on the last line", False)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_fields(parser, PlayArguments)


def run(namespace: argparse.Namespace) -> None:
    """Play, and print the figures and where the files are."""
    from arcgym.utils.registry import list_tasks

    args = read_fields(PlayArguments, namespace)
    if f"{args.task}{PLAY}" in list_tasks(prefix=""):
        args = replace(args, task=f"{args.task}{PLAY}")
    checkpoint = None
    if args.policy == "trained":
        env_cfg, agent_cfg, checkpoint = load_run_cfgs(args)
    else:
        env_cfg, agent_cfg = load_cfgs(args)

    from arcgym.rl.playing import PlayOptions, play

    options = PlayOptions(
        args.policy,
        checkpoint,
        args.device,
        args.steps,
        args.video_length if args.video else None,
        args.record,
        args.json,
        args.observations,
    )
    play(args.task, env_cfg, agent_cfg, options)
