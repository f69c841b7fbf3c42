#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw a recorded insertion over the colon's segments: where the tasks begin and end, looping, forces, marks.

python scripts/tools/insertion_plot.py assets/usd/colon_1/insertions/proximal.hdf5 docs/images/insertion.png
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

COLORS = ("#f3e3d3", "#e6eef7")


def main() -> None:
    """Read the recording and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", type=Path, help="recording (.hdf5)")
    parser.add_argument("picture", type=Path, help="picture to write (.png)")
    args = parser.parse_args()
    import matplotlib.pyplot as plt

    from arcgym.anatomy import read_colon
    from arcgym.managers import Episode
    from arcgym.utils.paths import resolve_asset
    from arcgym_tasks.navigation.segments import TIME_LIMIT_S

    episode = Episode.load(args.recording)
    bounds = read_colon(resolve_asset(episode.settings["scene"]["colon"]["usd_path"])).segment_bounds()
    figure, (way, force) = plt.subplots(2, 1, figsize=(9, 6.4), sharex=True, height_ratios=(2, 1))
    draw_way(way, episode, bounds, set(TIME_LIMIT_S))
    draw_forces(force, episode)
    figure.tight_layout()
    figure.savefig(args.picture, dpi=110)


def draw_way(axis: Any, episode: Any, bounds: dict[str, tuple[float, float]], tasks: set[str]) -> None:
    """Draw tip and inserted length over time, on bands of the segments."""
    time = episode.info["step_dt"] * (1 + np.arange(episode.info["length"]))
    arc = episode.data["poses/tip_arc_length"]
    for number, (name, (start, end)) in enumerate(bounds.items()):
        axis.axhspan(start, end, color=COLORS[number % 2], zorder=0)
        inside = np.flatnonzero(arc > start)
        entered = f", entered after {time[inside[0]]:.0f} s" if len(inside) else ", not reached"
        task = " (task)" if name in tasks else ""
        axis.text(1.02 * time[-1], 0.5 * (start + end), f"{name}{task}{entered}", va="center", fontsize=8)
        if len(inside):
            axis.plot(time[inside[0]], start, "o", color="black", markersize=4, zorder=3)
    axis.plot(time, arc, color="#a02030", label="arc length of the tip")
    axis.plot(time, episode.data["poses/inserted_length"], "--", color="#405060", label="length of scope inside")
    marks = [mark["step"] * episode.info["step_dt"] for mark in episode.info.get("marks", [])]
    axis.plot(marks, np.zeros(len(marks)), "|", color="black", label="states kept")
    axis.set(ylabel="[m]", xlim=(0, 1.42 * time[-1]), ylim=(0, max(end for _, end in bounds.values())))
    axis.legend(loc="upper left", fontsize=8)


def draw_forces(axis: Any, episode: Any) -> None:
    """Draw the forces over time."""
    time = episode.info["step_dt"] * (1 + np.arange(episode.info["length"]))
    axis.plot(time, episode.data["forces/base"], color="#405060", lw=0.8, label="push on the base")
    axis.plot(
        time, episode.data["forces/window_peak"].max(axis=1), color="#d09020", lw=0.8, label="50 mm of scope, peak"
    )
    axis.plot(time, episode.data["forces/tip_peak"], color="#a02030", lw=0.8, label="tip, peak")
    axis.set(xlabel="time [s]", ylabel="[N]")
    axis.grid(alpha=0.3)
    axis.legend(loc="upper left", fontsize=8, ncols=3)


if __name__ == "__main__":
    main()
