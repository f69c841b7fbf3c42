#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Generates a colon from a spec file, or a random patient from a seed, into a folder with ``colon.usda``.

The spec is YAML with any fields of ``arcgym.anatomy.ColonSpec``; what is left out keeps its default:

    name: my_colon
    segments: {sigmoid: {length: 0.6, diverticula: 5}}
    sigmoid_shape: looped
    polyp_list: [{segment: transverse, diameter: 0.008, paris: Ip}]
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from arcgym.anatomy import ColonSpec


def main() -> None:
    """Parses the command line and makes the colon."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("arguments", nargs="+", metavar="[SPEC.yaml] OUT", help="spec file, and folder for the stage")
    parser.add_argument("--seed", type=int, help="without a spec, draws a random patient; with one, replaces its seed")
    args = parser.parse_args()
    if len(args.arguments) > 2 or (len(args.arguments) == 1 and args.seed is None):
        parser.error("give SPEC.yaml OUT, or --seed N OUT")
    if args.seed is not None and args.seed < 0:
        parser.error(f"--seed {args.seed} is negative; expected 0 or more")
    *spec_path, out = map(Path, args.arguments)
    try:
        spec = choose_spec(spec_path, args.seed)
        make(spec, out)
    except ValueError as error:
        raise SystemExit(f"make_colon.py: {error}") from None


def choose_spec(path: list[Path], seed: int | None) -> ColonSpec:
    """Returns the spec from the file, if there is one, else a random patient's."""
    from dataclasses import replace

    from arcgym.anatomy.generator.population import draw_spec
    from arcgym.anatomy.generator.spec_file import read_spec

    if not path:
        assert seed is not None
        return draw_spec(seed)
    spec = read_spec(path[0])
    return spec if seed is None else replace(spec, seed=seed)


def make(spec: ColonSpec, out: Path) -> None:
    """Generates the colon beside the folder and moves it there when it is whole."""
    from arcgym.anatomy import make_colon, write_colon

    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise ValueError(f"{out} exists and is not an empty folder; choose another or remove it.")
    started = time.perf_counter()
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent, prefix=".making-") as folder:
        stage = make_colon(spec, Path(folder) / "colon")
        write_colon(stage, Path(folder) / "colon" / "colon.usda")
        if out.exists():
            out.rmdir()
        shutil.move(Path(folder) / "colon", out)
    print(f"{out / 'colon.usda'}: {spec.patient}, {stage.length:.2f} m, {time.perf_counter() - started:.1f} s")


if __name__ == "__main__":
    main()
