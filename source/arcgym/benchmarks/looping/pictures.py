# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the shaft from outside, and curves of the runs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from arcgym.scene import InteractiveScene
from arcgym.sensors import SkinnedSurface
from arcgym.viewers.outside_view import OutsideView, OutsideViewCfg

LABELS = {"push": "push", "push on": "push on, no roll", "loop": "push on, roll anticlockwise"}
"""Legend of the runs that push."""


def view_of(scene: InteractiveScene) -> Callable[[], np.ndarray]:
    """Return a function that draws the scene from the front."""
    colon, endoscope = scene["colon"], scene["endoscope"]
    proxy, scope = colon.stage.visual_proxy, endoscope.stage
    surface = SkinnedSurface(proxy, colon.wall, 1, scene.device)
    cfg = OutsideViewCfg(near_alpha=0.10, scope_share=0.7)
    arc = endoscope.data.window_arc.cpu().numpy()
    view = OutsideView(cfg, surface, proxy.points, scope.link_length, scope.link_radius, arc, scope.bending_links)

    def draw() -> np.ndarray:
        surface.update(colon.nodal_pos_wp)
        data: Any = endoscope.data
        pose = (data.body_pos_w[0].cpu().numpy(), data.body_quat_w[0].cpu().numpy())
        return view.render(*pose, data.window_force_norm[0].cpu().numpy())

    return draw


def save_views(views: dict[str, np.ndarray], path: Path) -> None:
    """Put the pictures of the pushed shaft, of the loop and of the one withdrawn clockwise side by side."""
    pictures = [views[name] for name in ("push", "loop", "clockwise")]
    Image.fromarray(np.concatenate(pictures, axis=1)).save(path, quality=85)


def draw_curves(runs: dict[str, list[dict[str, float]]], looping_time: float, path: Path) -> None:
    """Draw inserted length over tip progress, and views with a crossing and turning of the shaft over time.

    Args:
        runs: Rows of each run, one a control step.
        looping_time: Duration of pushing on [s].
        path: Picture to write.
    """
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(12.0, 3.6))
    pushed = runs["push"][-1]["time"]
    begin = {"push": 0.0, "push on": pushed, "loop": pushed}
    for name, rows in runs.items():
        label = LABELS.get(name, f"withdraw, roll {name}")
        column = {key: np.array([row[key] for row in rows]) for key in rows[0]}
        time = column["time"] + begin.get(name, pushed + looping_time)
        axes[0].plot(column["tip_arc"], column["inserted"], label=label)
        axes[1].plot(time, 100.0 * column["views"])
        axes[2].plot(time, column["turning"])
    axes[0].axline((0.2, 0.2), slope=1.0, color="0.7", lw=0.8)
    axes[0].set(xlabel="arc length of the tip [m]", ylabel="inserted length [m]")
    axes[0].legend(fontsize=7)
    axes[1].set(xlabel="time [s]", ylabel="views in which the shaft crosses itself [%]")
    axes[2].set(xlabel="time [s]", ylabel="turning of the shaft [deg]")
    figure.tight_layout()
    figure.savefig(path, dpi=110)
