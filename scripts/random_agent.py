# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Run a task with raw actions drawn uniformly from [-1, 1], to see that it works and what a policy has to beat."""

from __future__ import annotations

from arcgym.rl import cli

if __name__ == "__main__":
    cli.run_untrained("Run a task with raw actions drawn uniformly from [-1, 1].", "random_policy")
