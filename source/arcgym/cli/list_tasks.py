# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""List the registered tasks."""

from __future__ import annotations

import argparse
import sys

WIDE = 1000
"""Width of the table where no terminal cuts it, as in a file [characters]."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what may narrow the list."""
    parser.add_argument("keyword", nargs="?", default="", help="show only names that contain this")
    parser.add_argument("--cfgs", action="store_true", help="show the configurations' entry points too")


def run(args: argparse.Namespace) -> None:
    """Print a table of the tasks whose name contains the keyword."""
    import gymnasium as gym
    from rich.console import Console
    from rich.table import Column, Table

    from arcgym.utils.registry import list_tasks

    keys = ("env_cfg_entry_point", "rsl_rl_cfg_entry_point") if args.cfgs else ()
    heads = ("Task", *(("Environment configuration", "Agent configuration") if args.cfgs else ()))
    table = Table(*(Column(head, overflow="fold") for head in heads))
    names = [name for name in list_tasks(prefix="") if args.keyword.lower() in name.lower()]
    for name in names:
        table.add_row(name, *(str(gym.registry[name].kwargs.get(key, "-")) for key in keys))
    Console(width=None if sys.stdout.isatty() else WIDE).print(table)
    print(f"{len(names)} tasks")
