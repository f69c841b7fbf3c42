# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Compare the physics with theory and with converged references, on the shipped solver with its default settings.

Ends with status 1 if any row is out of its bound. Run for example::

    arcgym bench fidelity --quick --json
    arcgym bench fidelity --rows cantilever_small,buckling --device cuda:0
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import logging
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from arcgym.benchmarks.fidelity.rows import Check, Row, Run
from arcgym.benchmarks.fidelity.table import choose
from arcgym.utils.errors import UsageError

FORMAT = "{:26s}{:>12s}{:>12s}  {:6s}{:>10s}{:>9s}  {:6s} {}"
"""Columns of the table."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare which rows to measure and where."""
    parser.add_argument("--device", default="cpu", help="cpu or cuda:0 (default: cpu)")
    parser.add_argument("--rows", help="names of rows, separated by commas (default: all)")
    parser.add_argument("--quick", action="store_true", help="only checks that take seconds")
    parser.add_argument("--list", action="store_true", help="print the names of the rows and end")
    parser.add_argument("--plots", type=Path, help="folder for a picture of each check; needs matplotlib")
    parser.add_argument("--colons", nargs="+", default=(), help="stages of further colons for contact_search_*")
    parser.add_argument("--tables", type=Path, help="file for the figures behind the rows sensitivity_*, as JSON")
    parser.add_argument("--json", action="store_true", help="print the table as one JSON object on the last line")


def run(args: argparse.Namespace) -> int:
    """Measure the rows chosen, print them and return 1 if any is out of its bound."""
    try:
        chosen = choose(args.rows, args.quick)
    except ValueError as error:
        raise UsageError(str(error)) from error
    if args.plots and importlib.util.find_spec("matplotlib") is None:
        raise UsageError("--plots needs matplotlib, which is not installed: pip install matplotlib")
    if args.list:
        print("\n".join(name for check in chosen for name in check.rows))
        return 0
    from arcgym.rl.device import choose_device

    logging.basicConfig(level=logging.WARNING)
    rows = measure(chosen, choose_device(args.device), args.rows, args.plots, args.tables, args.colons)
    if args.json:
        print(json.dumps({"rows": [as_json(row) for row in rows]}))
    return 0 if all(row.ok for row in rows) else 1


def measure(
    checks: Sequence[Check],
    device: str,
    wanted: str | None,
    plots: Path | None = None,
    tables: Path | None = None,
    colons: Sequence[str] = (),
) -> list[Row]:
    """Run checks, print the table and return the rows that are wanted.

    Args:
        checks: The checks.
        device: Device of the simulations.
        wanted: Names of rows, separated by commas; None for all.
        plots: Folder for the pictures, if they are wanted.
        tables: File for the checks' further figures, if they are wanted.
        colons: Stages of further colons for the checks that take any.
    """
    print(FORMAT.format("row", "value", "reference", "unit", "error", "bound", "", "note"), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        run = Run(device, Path(folder), colons=tuple(colons))
        rows = [row for check in checks for row in measure_one(check, run, wanted)]
    if plots:
        from arcgym.benchmarks.fidelity.pictures import draw

        draw(run.plots, plots)
    if tables:
        tables.write_text(json.dumps(run.tables, indent=1) + "\n")
    return rows


def measure_one(check: Check, run: Run, wanted: str | None) -> list[Row]:
    """Run a check and print those of its rows that are wanted."""
    start = time.perf_counter()
    rows = [row for row in check.measure(run) if wanted is None or row.name in wanted.split(",")]
    for row in rows:
        print(describe(row), flush=True)
    print(f"{'':26s}({time.perf_counter() - start:.0f} s)", flush=True)
    return rows


def describe(row: Row) -> str:
    """Return one line of the table; relative errors in per cent."""
    scale = "{:+.2%}" if row.relative else "{:+.3g}"
    bound = "{:.0%}" if row.relative else "{:.3g}"
    verdict = "ok" if row.ok else "FAILED"
    numbers = (f"{row.value:.5g}", f"{row.reference:.5g}", row.unit, scale.format(row.error), bound.format(row.bound))
    return FORMAT.format(row.name, *numbers, verdict, row.note)


def as_json(row: Row) -> dict[str, object]:
    """Return the row's figures and verdict."""
    names = ("name", "value", "reference", "error", "bound", "ok", "unit", "relative", "note")
    return {name: getattr(row, name) for name in names}
