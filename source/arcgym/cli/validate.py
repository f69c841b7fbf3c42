# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Check colon stages: schema, units, meshes, lumen, landmarks, anchors, skinning, and that the wall holds still.

Prints one line a check with its figure and bound; the exit status is 0 if all checks of all stages pass, else 1.
``--experts`` adds how far each robot's scripted expert gets; that is no check, for it takes minutes and tells as much
about the expert as about the colon. ``--json`` adds a last line
``{"stages": [{"path", "ok", "checks": [{"name", "value", "bound", "ok"}], "experts": [{"robot", "reached_m"}]}]}``.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from arcgym.cli.arguments import positive
from arcgym.cli.expert_reach import ROBOTS, expert_reach
from arcgym.utils.errors import UsageError
from arcgym.utils.paths import resolve_stage

if TYPE_CHECKING:
    from arcgym.anatomy.validation.checks import Check


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the stages and how far to check them."""
    parser.add_argument(
        "stage", type=Path, nargs="+", help="stage files, names (colon_1), folders, splits (population:test)"
    )
    parser.add_argument("--json", action="store_true", help="print all figures as JSON in the last line")
    parser.add_argument(
        "--experts", nargs="*", choices=ROBOTS, metavar="ROBOT", help=f"drive experts up: {', '.join(ROBOTS)} (all)"
    )
    parser.add_argument(
        "--expert-time", type=positive, default=120, help="simulated time after which an expert gives up [s] (120)"
    )
    parser.add_argument("--no-physics", action="store_true", help="leave out the simulated second")


def run(args: argparse.Namespace) -> int:
    """Check the stages and return 1 if any check fails."""
    robots = args.experts or (ROBOTS if args.experts is not None else ())
    paths = [path for name in args.stage for path in stages_of(name)]
    reports = [check_stage(path, not args.no_physics, robots, args.expert_time) for path in paths]
    if args.json:
        print(json.dumps({"stages": reports}, allow_nan=False))
    return 0 if all(report["ok"] for report in reports) else 1


def stages_of(name: Path) -> list[Path]:
    """Return the stages that a word means: a file, one that comes along, those of a folder or of a population.

    Raises:
        UsageError: A folder has no stages, or there is no such population or split.
    """
    path = resolve_stage(name)
    if path.is_file() or not (path.is_dir() or ":" in str(name)):
        return [path]
    from arcgym.assets.patient_files import find_stages

    try:
        return find_stages(str(path) if path.is_dir() else str(name))
    except ValueError as error:
        raise UsageError(str(error)) from error


def check_stage(path: Path, physics: bool, robots: Sequence[str] = (), expert_time: float = 120.0) -> dict[str, Any]:
    """Check one stage, printing as it goes, and return its report.

    Args:
        path: The stage.
        physics: Whether to simulate a second.
        robots: Robots whose experts are driven up it, if it passes.
        expert_time: Simulated time after which an expert gives up [s].
    """
    print(path, flush=True)
    checks = []
    for check in all_checks(path, physics):
        print(f"  {'ok  ' if check.ok else 'FAIL'} {check}", flush=True)
        checks.append(check)
    rows = [{"name": c.name, "value": finite(c.value), "bound": finite(c.bound), "ok": c.ok} for c in checks]
    ok = all(check.ok for check in checks)
    print(f"  {'passes' if ok else 'FAILS'}", flush=True)
    experts = []
    for reach in expert_reach(path, robots if ok else (), expert_time):
        print(f"  {reach}", flush=True)
        experts.append(dataclasses.asdict(reach))
    return {"path": str(path), "ok": ok, "checks": rows, "experts": experts}


def finite(value: float) -> float | None:
    """Return the value as a plain number, None where it is not finite, which JSON cannot say."""
    return float(value) if math.isfinite(value) else None


def all_checks(path: Path, physics: bool) -> Iterator[Check]:
    """Yield the checks of one stage; those that need a readable stage only if it is."""
    from arcgym.anatomy.validation.stage_checks import inspect_file

    stage, checks = inspect_file(str(path))
    yield from checks
    if stage is None:
        return
    from arcgym.scene.colon_checks import physics_checks, skinning_checks

    yield from skinning_checks(stage)
    if physics and all(check.ok for check in checks):
        yield from physics_checks(path)
