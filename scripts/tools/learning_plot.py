#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw success and progress over transitions of the runs of one commit in ``docs/data/learning_runs.json``.

python scripts/tools/learning_plot.py 73bf9d9
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main() -> None:
    """Read the runs and write ``docs/images/learning_tasks.png``."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("commit", help="commit of the runs")
    commit = parser.parse_args().commit
    import matplotlib.pyplot as plt

    runs = json.loads((ROOT / "docs" / "data" / "learning_runs.json").read_text())["runs"].values()
    chosen = sorted((run for run in runs if run["commit"] == commit), key=lambda run: run["task"])
    if not chosen:
        parser.error(f"no runs of commit {commit}; there are {sorted({run['commit'] for run in runs})}")
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), sharey=True, layout="constrained")
    for run in chosen:
        style = "-" if run["task"].endswith("Magnetic") else "--"
        millions = [count / 1e6 for count in run["curves"]["transitions"]]
        for axis, name in zip(axes, ("success", "progress"), strict=True):
            axis.plot(millions, run["curves"][name], style, label=f"{run['task']}, {run['worlds']} worlds")
            axis.set(xlabel="transitions [million]", title=f"{name} of the episodes that ended")
            axis.grid(alpha=0.3)
    figure.legend(handles=axes[0].lines, loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    figure.savefig(ROOT / "docs" / "images" / "learning_tasks.png", dpi=110)


if __name__ == "__main__":
    main()
