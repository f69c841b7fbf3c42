# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw a colon on one page: from outside, its wall unrolled, and six views from inside with ARCGym's camera."""

from __future__ import annotations

import argparse
from pathlib import Path

from arcgym.utils.errors import UsageError
from arcgym.utils.paths import resolve_stage

SUFFIXES = (".png", ".jpg", ".jpeg")
"""Kinds of pictures."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the stage and the picture."""
    parser.add_argument("stage", type=Path, help="stage file (colon.usda), or name (colon_1)")
    parser.add_argument("out", type=Path, help="picture to write (.png or .jpg)")


def run(args: argparse.Namespace) -> None:
    """Write the picture."""
    if args.out.suffix.lower() not in SUFFIXES:
        raise UsageError(f"cannot write a picture '{args.out}'; expected a name that ends in {', '.join(SUFFIXES)}")
    from arcgym.anatomy import read_colon

    stage = read_colon(resolve_stage(args.stage))
    from arcgym.viewers.colon_page import draw_page

    args.out.parent.mkdir(parents=True, exist_ok=True)
    draw_page(stage).save(args.out, quality=85)
    print(args.out)
