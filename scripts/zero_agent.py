# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Run a task with raw actions that are zero; the same as ``arcgym zero``."""

from arcgym.cli.main import run_script

if __name__ == "__main__":
    raise SystemExit(run_script("zero"))
