# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Train a policy with rsl_rl; the same as ``arcgym train``."""

from arcgym.cli.main import run_script

if __name__ == "__main__":
    raise SystemExit(run_script("train"))
