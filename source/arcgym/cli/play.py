# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Run a trained policy, record it and export it.

    arcgym play --task ARC-Splenic-Proximal --video --record logs/episodes

Uses the -Play variant of the task with the run's own configurations; the command line's changes come on top and are
printed. It ends when each world's first episode has ended: these are the episodes that the success rate counts. The
video goes to videos/play of the run, the policy to exported. Where nothing was trained, and with
--use_pretrained_checkpoint, the policy shipped for the task or a journey of its robot plays, if there is one. --policy
zero, random and expert need no checkpoint; the scripted expert sees the centerline. --record writes every episode's
trajectory to a file.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

from arcgym.cli.arguments import DEFAULT_AGENT, FilmedRunArguments, add_fields, argument, positive, read_fields
from arcgym.cli.task import load_cfgs, load_run_cfgs
from arcgym.utils.errors import UsageError
from arcgym.utils.untrained import UNTRAINED

TAKES_OVERRIDES = True


@dataclass(frozen=True, kw_only=True)
class PlayArguments(FilmedRunArguments):
    """Arguments of ``arcgym play``."""

    policy: str = argument("source of the actions (default: trained)", "trained", choices=("trained", *UNTRAINED))
    steps: int | None = argument(
        "control steps (default: until each world's first episode has ended)", None, type=positive
    )
    record: str | None = argument("record trajectories: a folder, or a file ending in .hdf5", None, metavar="PATH")
    observations: bool = argument("record what the policy observes too, for imitation", False)
    json: bool = argument("print the figures as JSON on the last line", False)
    use_pretrained_checkpoint: bool = argument(
        "the policy shipped for this task or robot, if there is one (default where nothing was trained)", False
    )


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_fields(parser, PlayArguments)


def run(namespace: argparse.Namespace) -> None:
    """Play, and print the figures and where the files are."""
    from arcgym.utils.registry import list_tasks, play_task

    args = read_fields(PlayArguments, namespace)
    if play_task(args.task) in list_tasks(prefix=""):
        args = replace(args, task=play_task(args.task))
    checkpoint = None
    if args.policy == "trained":
        args = _with_pretrained(args)
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


def _with_pretrained(args: PlayArguments) -> PlayArguments:
    """Return the arguments with the shipped policy as checkpoint, where it is asked for or nothing was trained.

    Raises:
        UsageError: There is none where it is asked for or nothing was trained, or another is asked for as well.
    """
    from arcgym.rl.pretrained import pretrained_checkpoint
    from arcgym.rl.run_folder import has_checkpoints

    chosen = args.checkpoint or args.load_run
    agent = None if args.agent == DEFAULT_AGENT else args.agent
    if args.use_pretrained_checkpoint and chosen:
        raise UsageError(f"--use_pretrained_checkpoint and '{chosen}' are two checkpoints: leave one of them out.")
    env_cfg, agent_cfg = load_cfgs(args)
    goes_in = getattr(env_cfg, "direction", "insertion") == "insertion"
    if args.use_pretrained_checkpoint:
        return replace(args, checkpoint=str(pretrained_checkpoint(args.task, agent, goes_in)))
    if chosen or agent_cfg.load_checkpoint != "latest" or has_checkpoints(agent_cfg.experiment_name):
        return args
    try:
        path = pretrained_checkpoint(args.task, agent, goes_in)
    except UsageError as error:
        if args.experiment_name:
            return args
        trained = f"Nothing was trained in logs/rsl_rl/{agent_cfg.experiment_name}."
        raise UsageError(f"{trained} {error} --policy expert, zero and random need no checkpoint.") from error
    print(f"nothing was trained in logs/rsl_rl/{agent_cfg.experiment_name}: the policy that comes with ARCGym plays")
    return replace(args, checkpoint=str(path))
