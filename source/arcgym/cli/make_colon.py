# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Generate a colon from a spec file, or a random patient from a seed, into a folder with ``colon.usda``.

The spec is YAML with any fields of ``arcgym.anatomy.ColonSpec``; what is left out keeps its default:

    name: my_colon
    segments: {sigmoid: {length: 0.6, diverticula: 5}}
    sigmoid_shape: looped
    polyp_list: [{segment: transverse, diameter: 0.008, paris: Ip}]
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from arcgym.cli.arguments import whole
from arcgym.utils.errors import UsageError

if TYPE_CHECKING:
    from arcgym.anatomy import ColonSpec


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the spec, the seed and the folder."""
    parser.add_argument("paths", nargs="+", type=Path, metavar="[SPEC.yaml] OUT", help="spec file, and folder to make")
    seed = "without a spec, draws a random patient; with one, replaces its seed"
    parser.add_argument("--seed", type=whole(0), help=seed)


def run(args: argparse.Namespace) -> None:
    """Make the colon."""
    if len(args.paths) > 2 or (len(args.paths) == 1 and args.seed is None):
        raise UsageError("give SPEC.yaml OUT, or --seed N OUT")
    *spec_file, out = args.paths
    from arcgym.anatomy import AnatomyError
    from arcgym.anatomy.generator.output import check_folder, make_to_folder

    try:
        check_folder(out)
        spec = choose_spec(spec_file[0] if spec_file else None, args.seed)
    except ValueError as error:
        raise UsageError(str(error)) from error
    started = time.perf_counter()
    try:
        stage = make_to_folder(spec, out)
    except AnatomyError as error:
        raise SystemExit(f"arcgym make-colon: {error}") from error
    print(f"{out / 'colon.usda'}: {spec.patient}, {stage.length:.2f} m, {time.perf_counter() - started:.1f} s")


def choose_spec(path: Path | None, seed: int | None) -> ColonSpec:
    """Return the spec from the file, if there is one, else that of a random patient.

    Raises:
        ValueError: If the file holds no valid spec.
    """
    from arcgym.anatomy.generator.population import draw_spec
    from arcgym.anatomy.generator.spec_file import read_spec

    if path is None:
        assert seed is not None
        return draw_spec(seed)
    spec = read_spec(path)
    return spec if seed is None else replace(spec, seed=seed)
