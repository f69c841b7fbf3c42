# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Steer a robot by hand and record it, under Isaac Lab's name; the same as ``arcgym teleop``."""

from arcgym.cli.main import run_script

if __name__ == "__main__":
    raise SystemExit(run_script("teleop"))
