# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Policies that need no checkpoint, run in a task: what ``arcgym zero`` and ``arcgym random`` share."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

from arcgym.cli.arguments import TaskArguments, add_fields, argument, positive, read_fields
from arcgym.cli.task import load_cfgs


@dataclass(frozen=True, kw_only=True)
class UntrainedArguments(TaskArguments):
    """Arguments of ``arcgym zero`` and ``arcgym random``."""

    steps: int = argument("control steps (default: 100)", 100, type=positive)
    json: bool = argument("print the figures as JSON on the last line", False)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_fields(parser, UntrainedArguments)


def run_untrained(namespace: argparse.Namespace, policy: str) -> None:
    """Run the policy ``zero`` or ``random`` and print its figures."""
    args = read_fields(UntrainedArguments, namespace)
    env_cfg, agent_cfg = load_cfgs(args)

    from arcgym.rl.playing import PlayOptions, play

    play(args.task, env_cfg, agent_cfg, PlayOptions(policy, None, args.device, args.steps, json=args.json))
