# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Run a trained policy, record it and export it; the same as ``arcgym play``."""

from arcgym.cli.main import run_script

if __name__ == "__main__":
    raise SystemExit(run_script("play"))
