#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw success and progress over transitions of the runs of one commit in ``docs/data/learning_runs.json``.

python scripts/tools/learning_plot.py 0ec2dc0
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main() -> None:
    """Read the runs and write ``docs/images/learning_tasks.webp``."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("commit", help="commit of the runs")
    commit = parser.parse_args().commit
    import matplotlib.pyplot as plt

    runs = json.loads((ROOT / "docs" / "data" / "learning_runs.json").read_text())["runs"].values()
    chosen = sorted((run for run in runs if run["commit"] == commit), key=lambda run: (run["task"], run["seed"]))
    if not chosen:
        parser.error(f"no runs of commit {commit}; there are {sorted({run['commit'] for run in runs})}")
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), sharey=True, layout="constrained")
    tasks = list(dict.fromkeys(run["task"] for run in chosen))
    for run in chosen:
        first = run["seed"] == min(other["seed"] for other in chosen if other["task"] == run["task"])
        style = {
            "linestyle": "-" if run["task"].endswith("Magnetic") else "--",
            "color": f"C{tasks.index(run['task'])}",
        }
        thousands = [count / 1e3 for count in run["curves"]["transitions"]]
        for axis, name in zip(axes, ("success", "progress"), strict=True):
            label = run["task"] if first else "_"  # a line without an entry
            axis.plot(thousands, run["curves"][name], label=label, linewidth=1.2, **style)
            axis.set(xlabel="transitions [thousand]", title=f"{name} of the episodes that ended")
            axis.grid(alpha=0.3)
    named = [line for line in axes[0].lines if line.get_label() != "_"]
    figure.legend(handles=named, loc="outside lower center", ncols=4, fontsize=8, frameon=False)
    figure.savefig(ROOT / "docs" / "images" / "learning_tasks.webp", dpi=90, pil_kwargs={"quality": 70})


if __name__ == "__main__":
    main()
