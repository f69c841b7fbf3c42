# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""List the registered tasks; the same as ``arcgym list``."""

from arcgym.cli.main import run_script

if __name__ == "__main__":
    raise SystemExit(run_script("list"))
