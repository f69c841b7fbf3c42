# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""``python -m arcgym``: the same as the command ``arcgym``."""

from __future__ import annotations

from arcgym.cli.main import main

if __name__ == "__main__":
    raise SystemExit(main())
