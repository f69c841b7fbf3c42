# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Train a grid of algorithms, tasks, robots and seeds; the same as ``arcgym study``."""

from arcgym.cli.main import run_script

if __name__ == "__main__":
    raise SystemExit(run_script("study"))
