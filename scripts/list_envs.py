# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""List the registered tasks. Imports neither torch nor Newton."""

from __future__ import annotations

import argparse

import gymnasium as gym
from rich.console import Console
from rich.table import Table

from arcgym.utils.registry import list_tasks


def main() -> None:
    """Print a table of the tasks whose name contains the keyword."""
    parser = argparse.ArgumentParser(description="List the registered tasks.")
    parser.add_argument("keyword", nargs="?", default="", help="show only names that contain this")
    parser.add_argument("--cfgs", action="store_true", help="show the configurations' entry points too")
    args = parser.parse_args()
    table = Table("Task", *(["Environment configuration", "Agent configuration"] if args.cfgs else []))
    names = [name for name in list_tasks(prefix="") if args.keyword.lower() in name.lower()]
    for name in names:
        table.add_row(name, *(_entry_points(name) if args.cfgs else []))
    Console().print(table)
    print(f"{len(names)} tasks")


def _entry_points(task: str) -> list[str]:
    kwargs = gym.registry[task].kwargs
    return [str(kwargs.get(key, "-")) for key in ("env_cfg_entry_point", "rsl_rl_cfg_entry_point")]


if __name__ == "__main__":
    main()
