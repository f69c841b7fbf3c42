# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Run a task with raw actions drawn uniformly from [-1, 1]; the same as ``arcgym random``."""

from arcgym.cli.main import run_script

if __name__ == "__main__":
    raise SystemExit(run_script("random"))
