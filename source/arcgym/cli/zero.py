# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Run a task with raw actions that are zero, to see that it works and what a policy has to beat."""

from __future__ import annotations

import argparse

from arcgym.cli.untrained import add_arguments as add_arguments
from arcgym.cli.untrained import run_untrained

TAKES_OVERRIDES = True


def run(args: argparse.Namespace) -> None:
    """Run the policy and print its figures."""
    run_untrained(args, "zero")
