#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw a training run's curves beside the zero-action agent's figures, and writes both as JSON.

python scripts/benchmarks/plot_training.py logs/rsl_rl/arc_sigmoid_magnetic/<run> --out OUT.png --zero zero.json

Several folders are one run that was resumed: their curves follow each other.
``zero.json`` holds the line that ``scripts/zero_agent.py --json`` or ``play.py --policy zero --json`` prints last. The
curves go to ``OUT.json`` beside the picture. Needs matplotlib (``pip install arcgym[dev]``).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

PANELS = {
    "reward an episode": ("Train/mean_reward", "reward_per_episode"),
    "centering s_c": ("Episode_Metrics/s_c", "metrics"),
    "success": ("Episode_Metrics/success", "metrics"),
    "largest shaft force [N]": ("Episode_Metrics/max_shaft_force", "metrics"),
}
"""Title of each panel, its tag in the log, and where the zero agent's figure is."""


def main() -> None:
    """Read the log, draw, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path, nargs="+", help="folder of the run, or its events file, in order")
    parser.add_argument("--out", type=Path, required=True, help="picture to write")
    parser.add_argument("--zero", type=Path, help="JSON of the zero-action agent")
    parser.add_argument("--title", default="", help="title of the picture")
    args = parser.parse_args()
    curves = read_curves(args.runs)
    zero = json.loads(args.zero.read_text().strip().splitlines()[-1]) if args.zero else None
    args.out.with_suffix(".json").write_text(
        json.dumps({"title": args.title, "curves": curves, "zero": zero}, indent=1)
    )
    draw(curves, zero, args.title, args.out)


def read_curves(runs: list[Path]) -> dict[str, list[float]]:
    """Return the transitions so far and one list a panel, each with an entry an iteration."""
    curves: dict[str, list[float]] = {title: [] for title in [*PANELS, "transitions"]}
    total = 0.0
    for run in runs:
        log = EventAccumulator(str(run))
        log.Reload()
        for title, (tag, _) in PANELS.items():
            curves[title] += [round(event.value, 5) for event in log.Scalars(tag)]
        names = ("Perf/total_fps", "Perf/collection_time", "Perf/learning_time")
        for rate, collection, learning in zip(*(log.Scalars(name) for name in names), strict=True):
            total += rate.value * (collection.value + learning.value)
            curves["transitions"].append(round(total))
    return curves


def draw(curves: dict[str, list[float]], zero: dict | None, title: str, out: Path) -> None:
    """Draw one panel a curve, the zero-action agent as a dashed line."""
    fig, axes = plt.subplots(1, len(PANELS), figsize=(4 * len(PANELS), 3.2), layout="constrained")
    for axis, (name, (tag, where)) in zip(axes, PANELS.items(), strict=True):
        values = curves[name]
        axis.plot([t / 1000 for t in curves["transitions"][-len(values) :]], values, color="#b03a48", label="PPO")
        if zero is not None:
            base = zero["metrics"].get(tag) if where == "metrics" else zero[where]
            axis.axhline(base, color="#555", linestyle="--", label="zero action")
        axis.set(title=name, xlabel="transitions [thousand]")
        axis.grid(alpha=0.3)
    axes[0].legend()
    fig.suptitle(title)
    fig.savefig(out, dpi=110)


if __name__ == "__main__":
    main()
