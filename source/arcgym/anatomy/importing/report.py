# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Report of an import beside the stage: figures in ``report.json`` and a page of pictures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.anatomy.importing.doubts import check_doubts
from arcgym.anatomy.importing.pipeline import ImportedColon
from arcgym.anatomy.importing.preflight import MADE_BY
from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.stage.types import ColonStage
from arcgym.anatomy.validation.stage_checks import inspect_stage
from arcgym.anatomy.validation.wall_checks import ring_radii

REPORT_NAME = "report.json"
"""File of the figures."""

PAGE_NAME = "report.png"
"""File of the pictures."""

_COLORS = ("#4c72b0", "#dd8452", "#55a868", "#c44e52", "#8172b3", "#937860", "#da8bc3", "#8c8c8c")
"""Color of each segment."""


def figures(imported: ImportedColon) -> dict[str, Any]:
    """Return all figures of an import, ready for JSON."""
    stage = imported.stage
    bounds = stage.segment_bounds()
    radii = ring_radii(stage.wall)
    checks = [
        {"name": c.name, "value": float(c.value), "bound": float(c.bound), "ok": bool(c.ok)}
        for c in inspect_stage(stage)
    ]
    return {
        "made_by": MADE_BY,
        **imported.report,
        "length_mm": _mm(stage.length),
        "segment_length_mm": {name: _mm(end - start) for name, (start, end) in bounds.items()},
        "landmark_mm": {name: _mm(arc) for name, arc in stage.landmarks.items()},
        "lumen_radius_mm": {f"p{q}": _mm(np.quantile(stage.centerline.radius, q / 100)) for q in (5, 50, 95)},
        "least_wall_radius_mm": _mm(radii.min()),
        "share_mended": round(imported.fitted.mended, 4),
        "vertices": {
            "wall": len(stage.wall.points),
            "visual": len(stage.visual.points),
            "proxy": len(stage.visual_proxy.points),
        },
        "metadata": stage.metadata,
        "checks": checks,
        "doubts": [*imported.report["doubts"], *check_doubts(checks)],
    }


def write_report(imported: ImportedColon, folder: Path) -> dict[str, Any]:
    """Write ``report.json`` and ``report.png`` and return the figures."""
    report = figures(imported)
    (folder / REPORT_NAME).write_text(json.dumps(report, indent=2) + "\n")
    _draw_page(imported, folder / PAGE_NAME)
    return report


def _mm(value: float) -> float:
    return round(1e3 * float(value), 2)


def _draw_page(imported: ImportedColon, path: Path) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 11), layout="constrained")
    FigureCanvasAgg(figure)
    views = figure.add_gridspec(3, 3, height_ratios=(3, 1.3, 1.6))
    for column, axes in enumerate(((0, 2), (1, 2), (0, 1))):
        _draw_projection(figure.add_subplot(views[0, column]), imported, axes)
    _draw_radius(figure.add_subplot(views[1, :]), imported.stage, imported.report["landmark_uncertainty_mm"])
    _draw_unrolled(figure.add_subplot(views[2, :]), imported.stage)
    lines = "\n".join(_cleaning_lines(imported.report["cleaning"]))
    figure.suptitle(f"{imported.stage.name}: {_mm(imported.stage.length):.0f} mm\n{lines}", fontsize=9)
    figure.savefig(path, dpi=110)


def _cleaning_lines(cleaning: dict[str, Any]) -> list[str]:
    """Return in words what was bridged, dropped, cut off and left, at most six lines."""
    lines = [f"bridged a gap of {b['gap_mm']:.0f} mm at {b['place_mm']}" for b in cleaning["bridges"]]
    for cut in cleaning["cut"]:
        size = f", {cut['length_mm']} mm long, {cut['caliber_mm']:.0f} mm wide" if "length_mm" in cut else ""
        at = f" at {cut['place_mm']}" if "place_mm" in cut else ""
        lines.append(f"cut off: {cut['kind']}, {cut['volume_ml']:.0f} ml{size}{at}")
    lines += [f"left: {p['kind']}, {p['length_mm']} mm long at {p['place_mm']}" for p in cleaning["pouches"]]
    lines += [f"dropped a piece of {d['volume_ml']:.0f} ml at {d['place_mm']}" for d in cleaning["dropped"]]
    return lines[:6] + ([f"and {len(lines) - 6} more, see {REPORT_NAME}"] if len(lines) > 6 else [])


def _draw_projection(axis: Any, imported: ImportedColon, axes: tuple[int, int]) -> None:
    """Draw the cleaned lumen seen through, with the centerline in the colors of its segments."""
    grid = imported.grid
    (hidden,) = set(range(3)) - set(axes)
    depth = grid.values.sum(hidden) * grid.spacing
    low, high = grid.origin, grid.origin + grid.spacing * (np.array(grid.values.shape) - 1)
    extent = (low[axes[0]], high[axes[0]], low[axes[1]], high[axes[1]])
    axis.imshow(depth.T, origin="lower", extent=extent, cmap="Greys", alpha=0.8)
    path, line = imported.path, imported.stage.centerline
    segment = np.interp(np.linspace(0, 1, len(path)), line.arc / line.arc[-1], line.segment).round().astype(int)
    for k, name in enumerate(SEGMENTS):
        part = path[segment == k]
        axis.plot(part[:, axes[0]], part[:, axes[1]], color=_COLORS[k], lw=2, label=name)
    cleaning = imported.report["cleaning"]
    for mark in (*cleaning["bridges"], *cleaning["cut"], *cleaning["pouches"]):
        if "place_mm" in mark:
            place = 1e-3 * imported.rotation @ np.array(mark["place_mm"])
            axis.plot(place[axes[0]], place[axes[1]], "x", color="black", ms=8)
    for window in imported.report["windows"]:
        place = 1e-3 * np.array(window["place_mm"])
        axis.plot(place[axes[0]], place[axes[1]], "s", color="#c44e52", ms=5, mfc="none")
    names = ("right", "anterior", "cranial")
    axis.set_xlabel(f"{names[axes[0]]} [m]")
    axis.set_ylabel(f"{names[axes[1]]} [m]")
    if axes == (0, 2):
        axis.legend(fontsize=7)


def _draw_radius(axis: Any, stage: ColonStage, uncertain: dict[str, float | None]) -> None:
    """Draw the radii along the colon, and the landmarks with how far they may be off."""
    line, wall = stage.centerline, stage.wall
    axis.plot(1e3 * line.arc, 1e3 * line.radius, color="black", label="mean measured radius")
    axis.plot(1e3 * wall.ring_arc, 1e3 * ring_radii(wall), color="#c44e52", lw=1, label="least radius of the wall")
    for name, arc in stage.landmarks.items():
        axis.axvline(1e3 * arc, color="0.7", lw=0.8)
        half = uncertain.get(name) or 0.0
        axis.axvspan(1e3 * arc - half, 1e3 * arc + half, color="0.7", alpha=0.15, lw=0)
        axis.text(1e3 * arc, axis.get_ylim()[1], name.replace("_", " "), rotation=20, fontsize=6)
    axis.set_ylabel("radius [mm]")
    axis.legend(fontsize=7)


def _draw_unrolled(axis: Any, stage: ColonStage) -> None:
    """Draw the visual surface cut open along its seam: distance from the centerline, dark on folds."""
    visual, line, wall = stage.visual, stage.centerline, stage.wall
    arc = (visual.skin_weights * wall.ring_arc[wall.ring[visual.skin_indices]]).sum(1)
    columns = int(np.argmax(arc > arc[0]))
    center = np.stack([np.interp(arc[::columns], line.arc, line.points[:, k]) for k in range(3)], 1)
    rows = visual.points.reshape(-1, columns, 3)
    distance = np.linalg.norm(rows - center[:, None], axis=2)
    shown = distance - distance.mean(1, keepdims=True)
    axis.imshow(1e3 * shown.T, aspect="auto", cmap="copper", vmin=-8, vmax=8, extent=(0, _mm(stage.length), 0, 360))
    axis.set_xlabel("arc length [mm]")
    axis.set_ylabel("angle [deg]")
