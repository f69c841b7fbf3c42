#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw throughput over the number of worlds from the JSON that ``throughput.py`` printed, beside the paper's figures.

Several files become several curves. Needs matplotlib (``pip install arcgym[dev]``). Run for example::

    python scripts/benchmarks/plot_throughput.py docs/data/throughput_h100.json throughput_cpu.json \\
        --out docs/images/throughput.png
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from arcgym.benchmarks.paper import CONTROL_DT, PAPER_RATE

Curve = tuple[str, list[int], list[float]]
"""Name, numbers of worlds and simulated seconds per second over all of them."""


def main() -> None:
    """Read the files and draw them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", type=Path, nargs="+", help="output of throughput.py --json")
    parser.add_argument("--out", type=Path, required=True, help="picture to write")
    args = parser.parse_args()
    try:
        curves = [read_curve(path) for path in args.files]
    except (OSError, ValueError) as error:
        parser.error(str(error))
    draw(curves, args.out)
    print(args.out)


def read_curve(path: Path) -> Curve:
    """Return the curve of a file, whose last line is the JSON; rows with an error are left out.

    Raises:
        ValueError: If the file is no output of ``throughput.py``, or no row of it succeeded.
    """
    lines = path.read_text().strip().splitlines() or [""]
    try:
        report: dict[str, Any] = json.loads(lines[-1])
        rows = [row for row in report["rows"] if "error" not in row]
        counts = [row["num_envs"] for row in rows]
        rates = [row["sim_s_per_wall_s"] for row in rows]
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path} is no output of throughput.py --json ({error!r})") from error
    if not rows:
        raise ValueError(f"{path}: no number of worlds was measured")
    return report["device"], counts, rates


def draw(curves: list[Curve], out: Path) -> None:
    """Draw simulated seconds per second over worlds, both logarithmic."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, axis = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
    for name, counts, rates in curves:
        axis.loglog(counts, rates, marker="o", label=name)
    paper = [rate * CONTROL_DT for rate in PAPER_RATE.values()]
    axis.loglog(
        list(PAPER_RATE), paper, marker="x", linestyle="--", color="#555", label="the paper, RTX PRO 6000, with PPO"
    )
    axis.axhline(1.0, color="#999", linewidth=0.8)
    axis.annotate("real time", (1.0, 1.0), xycoords=("axes fraction", "data"), ha="right", va="bottom", color="#777")
    worlds = sorted({count for _, counts, _ in curves for count in counts} | set(PAPER_RATE))
    axis.set_xticks(worlds, [str(count) for count in worlds])
    axis.set_xticks([], minor=True)
    axis.set(xlabel="worlds", ylabel="simulated seconds per second, all worlds")
    axis.grid(alpha=0.3)
    axis.legend()
    fig.savefig(out, dpi=110)


if __name__ == "__main__":
    main()
