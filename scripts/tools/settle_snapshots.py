# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Measures whether the start states beside the shipped colons are at rest, and lets those settle again that are not.

    python scripts/tools/settle_snapshots.py --json rest.jsonl
    python scripts/tools/settle_snapshots.py --settle --robots proximal --tissues in_situ

A state is at rest if no force changes by more than 5 % within 3 s without commands, as in the rows ``start_rest_*`` of
docs/fidelity.md. All colons of one robot in one tissue are one batch, one world a state.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from arcgym.benchmarks.fidelity.checks.resting import BOUND, COLONS
from arcgym.start_states.settling import changes
from arcgym.start_states.shipped import Shipped, load

ROBOTS = ("capsule", "magnetic", "proximal")
TISSUES = ("paper", "in_situ")
ROUNDS = 4
"""How often a state may settle, for 10 s at most each."""

Keys = Sequence[tuple[int, str]]
Rows = list[dict[str, Any]]


def measure(shipped: Shipped, keys: Keys) -> Rows:
    """Return how far the forces of some states change, one row a state, with the force that changes most [N]."""
    forces = shipped.left_alone(keys)
    change = changes(forces)
    rows = []
    for k, (patient, name) in enumerate(keys):
        kind = int(change[:, k].max(axis=0).argmax())
        own = change[:, k, kind]
        row = {"colon": shipped.colon(patient), "segment": name, "change": round(float(own.max()), 4)}
        first, then = forces[0, k, kind], forces[own.argmax(), k, kind]
        rows.append({**row, "force": ("window", "base")[kind], "from": round(first, 3), "to": round(then, 3)})
    return rows


def moving(keys: Keys, rows: Rows) -> list[tuple[int, str]]:
    """Return the states that are not at rest."""
    return [key for key, row in zip(keys, rows, strict=True) if not row["change"] <= BOUND]


def settle_again(shipped: Shipped, left: list[tuple[int, str]], say: Callable[[Rows, int], None]) -> None:
    """Let states settle until they are at rest, and replace their files."""
    touched = {patient for patient, _ in left}
    for attempt in range(1, ROUNDS + 1):
        if left:
            shipped.settle(left)
            rows = measure(shipped, left)
            say(rows, attempt)
            left = moving(left, rows)
    for patient in touched:
        shipped.save(patient)


def main() -> None:
    """Parse the arguments and go through robots and tissues."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--colons", nargs="+", default=COLONS, help="colons (default: all that ship)")
    parser.add_argument("--robots", nargs="+", default=ROBOTS, choices=ROBOTS)
    parser.add_argument("--tissues", nargs="+", default=TISSUES)
    parser.add_argument("--device", default="cpu", help="cpu or cuda:<n> (default: cpu)")
    parser.add_argument("--settle", action="store_true", help="settle those that are not at rest, in place")
    parser.add_argument("--json", type=Path, help="file to which a line a state is appended")
    args = parser.parse_args()
    for robot, tissue in [(robot, tissue) for tissue in args.tissues for robot in args.robots]:
        began, shipped = time.monotonic(), load(robot, tissue, args.colons, args.device)

        def say(rows: Rows, settled: int, robot: str = robot, tissue: str = tissue) -> None:
            lines = [json.dumps({"robot": robot, "tissue": tissue, **row, "settled": settled}) for row in rows]
            print("\n".join(lines), flush=True)
            if args.json is not None:
                with args.json.open("a") as file:
                    file.write("".join(f"{line}\n" for line in lines))

        rows = measure(shipped, shipped.keys)
        say(rows, 0)
        if args.settle:
            settle_again(shipped, moving(shipped.keys, rows), say)
        print(f"{robot}, {tissue}: {time.monotonic() - began:.0f} s", flush=True)


if __name__ == "__main__":
    main()
