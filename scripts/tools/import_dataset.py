#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The same as ``arcgym import-dataset``."""

from arcgym.cli.main import run_script

if __name__ == "__main__":
    raise SystemExit(run_script("import-dataset"))
