#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Plot the insertions of ``arcgym bench clinical`` beside published figures.

python scripts/tools/clinical_plot.py logs/clinical docs/images/clinical.png
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from arcgym.benchmarks.clinical.figures import Insertion, read

COLORS = {"paper": "tab:gray", "in_situ": "tab:blue", "clinical": "tab:red", "examiner": "tab:orange"}
GATHERED, SHAFT = 0.56, (0.7, 0.9)
"""Published: scope inside over length of colon, and scope inside [m], in the cecum."""
APPLEYARD = ((10.0, 0.05), (43.0, 0.0))
"""Published: share of the time above a push or pull [N], and the highest."""


def main() -> None:
    """Read and plot."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder of the insertions")
    parser.add_argument("picture", type=Path, help="picture to write (.png)")
    args = parser.parse_args()
    found = {name: read(args.folder / name) for name in COLORS if (args.folder / name).is_dir()}
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.4), constrained_layout=True)
    plot_ways(left, found)
    plot_forces(right, found)
    figure.savefig(args.picture, dpi=80)


def plot_ways(axes: plt.Axes, found: Mapping[str, Sequence[Insertion]]) -> None:
    """Plot the way of the tip over the scope inside."""
    for name, insertions in found.items():
        for number, one in enumerate(insertions):
            label = f"{name}" if number == 0 else None
            axes.plot(one["inserted"], one["arc"], color=COLORS[name], lw=0.6, alpha=0.6, label=label)
    most = 1.7
    axes.plot([0.0, most], [0.0, most], color="black", lw=0.8, ls=":", label="nothing gathered, no loop")
    axes.fill_between(SHAFT, [at / GATHERED for at in SHAFT], 0.0, color="tab:green", alpha=0.15)
    axes.plot(SHAFT, [at / GATHERED for at in SHAFT], color="tab:green", lw=3, label="published, in the cecum")
    axes.set(xlabel="scope inside [m]", ylabel="tip along the colon at rest [m]", xlim=(0.0, most), ylim=(0.0, 2.2))
    axes.legend(fontsize=7)


def plot_forces(axes: plt.Axes, found: Mapping[str, Sequence[Insertion]]) -> None:
    """Plot the share of the time above a push or pull."""
    grid = np.linspace(0.0, 45.0, 181)
    for name, insertions in found.items():
        force = np.abs(np.concatenate([one["push"][one.felt] for one in insertions]))
        axes.plot(grid, [float((force > at).mean()) for at in grid], color=COLORS[name], label=name)
    axes.plot(*APPLEYARD[0], "o", color="tab:green", label="Appleyard et al. 2000")
    axes.axvline(APPLEYARD[1][0], color="tab:green", lw=1, ls="--")
    axes.set(xlabel="push or pull [N]", ylabel="share of the time above", ylim=(0.0, 1.0), xlim=(0.0, 45.0))
    axes.legend(fontsize=7)


if __name__ == "__main__":
    main()
