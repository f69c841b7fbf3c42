# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Evaluate an agent on the trials of a suite; the same as ``arcgym evaluate``."""

from arcgym.cli.main import run_script

if __name__ == "__main__":
    raise SystemExit(run_script("evaluate"))
