# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Make the start states of a task ahead; the same as ``arcgym snapshots``."""

from arcgym.cli.main import run_script

if __name__ == "__main__":
    raise SystemExit(run_script("snapshots"))
