#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the physics with theory and with converged references, on the shipped solver with its default settings.

Ends with status 1 if any row is out of its bound. Run for example::

    python scripts/benchmarks/fidelity.py --quick --json
    python scripts/benchmarks/fidelity.py --rows cantilever_small,buckling --device cuda:0
"""

from __future__ import annotations

import argparse
import importlib
import json
import logging
import sys
import tempfile
import time
from pathlib import Path

from fidelity_checks.table import CHECKS, Check, Row, Run

GROUPS = ("scope", "wall", "indentation", "insertion", "contact", "transmission", "commands", "stability")
"""Files with checks, in the order of the table."""
FORMAT = "{:26s}{:>12s}{:>12s}  {:6s}{:>10s}{:>9s}  {:6s} {}"
"""Columns of the table."""


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cpu", help="cpu or cuda:0 (default: cpu)")
    parser.add_argument("--rows", help="names of rows, separated by commas (default: all)")
    parser.add_argument("--quick", action="store_true", help="only checks that take seconds")
    parser.add_argument("--list", action="store_true", help="print the names of the rows and end")
    parser.add_argument("--plots", type=Path, help="folder for a picture of each check; needs matplotlib")
    parser.add_argument("--json", action="store_true", help="print the table as one JSON object on the last line")
    return parser


def main() -> None:
    """Run the checks chosen and print their rows."""
    parser = make_parser()
    args = parser.parse_args()
    load_checks()
    try:
        chosen = choose(args.rows, args.quick)
    except ValueError as error:
        parser.error(str(error))
    if args.list:
        print("\n".join(name for check in chosen for name in check.rows))
        return
    logging.basicConfig(level=logging.WARNING)
    print(FORMAT.format("row", "value", "reference", "unit", "error", "bound", "", "note"), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        run = Run(args.device, Path(folder))
        rows = [row for check in chosen for row in measured(check, run, args.rows)]
    if args.plots:
        from fidelity_checks.pictures import draw

        draw(run.plots, args.plots)
    if args.json:
        print(json.dumps({"rows": [as_json(row) for row in rows]}))
    sys.exit(0 if all(row.ok for row in rows) else 1)


def load_checks() -> None:
    """Import the files that enter their checks, in the order of the table."""
    for name in GROUPS:
        importlib.import_module(f"fidelity_checks.{name}")


def choose(rows: str | None, quick: bool) -> list[Check]:
    """Checks that give the named rows, or all; only the quick ones if so wished.

    Raises:
        ValueError: If there is no row of a name.
    """
    known = [name for check in CHECKS for name in check.rows]
    wanted = set(rows.split(",")) if rows else set(known)
    unknown = sorted(wanted - set(known))
    if unknown:
        raise ValueError(f"--rows names {unknown}; the rows are {', '.join(known)}")
    return [check for check in CHECKS if wanted & set(check.rows) and (check.quick or not quick)]


def measured(check: Check, run: Run, wanted: str | None) -> list[Row]:
    """Run a check and print those of its rows that are wanted."""
    start = time.perf_counter()
    rows = [row for row in check.measure(run) if wanted is None or row.name in wanted.split(",")]
    for row in rows:
        print(describe(row), flush=True)
    print(f"{'':26s}({time.perf_counter() - start:.0f} s)", flush=True)
    return rows


def describe(row: Row) -> str:
    """One line of the table; relative errors in per cent."""
    scale = "{:+.2%}" if row.relative else "{:+.3g}"
    bound = "{:.0%}" if row.relative else "{:.3g}"
    verdict = "ok" if row.ok else "FAILED"
    numbers = (f"{row.value:.5g}", f"{row.reference:.5g}", row.unit, scale.format(row.error), bound.format(row.bound))
    return FORMAT.format(row.name, *numbers, verdict, row.note)


def as_json(row: Row) -> dict[str, object]:
    """The row's figures and verdict."""
    return {key: getattr(row, key) for key in ("name", "value", "reference", "error", "bound", "ok")}


if __name__ == "__main__":
    main()
