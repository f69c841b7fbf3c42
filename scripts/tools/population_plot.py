# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draw the geometry of random patients beside that of real colons, and print the table of docs/patients.md."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "docs" / "images" / "population.png"

ROWS = (
    ("bend_radius_p5", "bend radius, 5th percentile [mm]", 1e3, (15.0, 18.0)),
    ("bend_radius_least", "bend radius, least [mm]", 1e3, (14.0, 15.0)),
    ("tight_share", "course tighter than 25 mm [%]", 1e2, (19.0, 33.0)),
    ("turning_p95", "turn over 60 mm, 95th percentile [deg]", 57.29578, (113.0, 154.0)),
    ("turning_most", "turn over 60 mm, largest [deg]", 57.29578, (140.0, 171.0)),
    ("total_turning", "total turning [deg/m]", 57.29578, (1270.0, 1640.0)),
    ("bend_over_lumen_p5", "bend over lumen radius, 5th percentile", 1.0, (0.85, 1.0)),
    ("diameter_p5", "lumen diameter, 5th percentile [mm]", 1e3, (21.0, 31.0)),
    ("diameter_p50", "lumen diameter, median [mm]", 1e3, (28.0, 44.0)),
    ("diameter_p95", "lumen diameter, 95th percentile [mm]", 1e3, (55.0, 63.0)),
    ("length", "length [m]", 1.0, (1.0, 2.1)),
    ("acute_bends", "acute bends", 1.0, (5.0, 20.0)),
)
"""Measure, title, factor of its unit, and range in five colons from CT; of the acute bends, in three others besides."""


def main() -> None:
    """Measure, print and draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, nargs=2, default=(10000, 10039), help="first and last seed")
    parser.add_argument("--out", type=Path, default=OUT, help="picture to write")
    args = parser.parse_args()
    values = measure(range(args.seeds[0], args.seeds[1] + 1))
    for name, title, factor, (low, high) in ROWS:
        print(f"| {title} | {low:g}-{high:g} | {summary([factor * value for value in values[name]])} |")
    draw(values, args.out)
    print(args.out)


def measure(seeds: range) -> dict[str, list[float]]:
    """Measure the first valid course of each seed."""
    from arcgym.anatomy.course_measures import measure_course
    from arcgym.anatomy.generator.acceptance import check_course
    from arcgym.anatomy.generator.generate import draw_surface
    from arcgym.anatomy.generator.population import draw_spec
    from arcgym.anatomy.validation.checks import failed

    values: dict[str, list[float]] = {name: [] for name, *_ in ROWS}
    for seed in seeds:
        spec = draw_spec(seed)
        draws = (draw_surface(spec, attempt)[0] for attempt in range(spec.max_attempts))
        surface = next(surface for surface in draws if not failed(check_course(spec, surface)))
        found = measure_course(surface.curve.points, surface.mean_radius)
        widths = dict(zip(("diameter_p5", "diameter_p50", "diameter_p95"), found.diameter, strict=True))
        for name, row in values.items():
            row.append(float(widths[name] if name in widths else getattr(found, name)))
        print(f"\r{seed - seeds.start + 1} of {len(seeds)}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return values


def summary(values: list[float]) -> str:
    """Return median and the 5th and 95th percentiles in words."""
    import numpy as np

    low, middle, high = np.percentile(values, [5, 50, 95])
    return f"{middle:.3g} ({low:.3g}-{high:.3g})"


def draw(values: dict[str, list[float]], out: Path) -> None:
    """Draw a histogram of each measure over the range of the real colons."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(3, 4, figsize=(13.5, 7.2), constrained_layout=True)
    for axis, row in zip(axes.ravel(), ROWS, strict=True):
        _draw_one(axis, values, row)
    count = len(values["length"])
    figure.suptitle(f"{count} random patients (bars) and the range of five colons from CT (shaded)", fontsize=11)
    figure.savefig(out, dpi=80)


def _draw_one(axis: Any, values: dict[str, list[float]], row: tuple[str, str, float, tuple[float, float]]) -> None:
    name, title, factor, (low, high) = row
    axis.axvspan(low, high, color="#9ecae1", alpha=0.6, lw=0)
    axis.hist([factor * value for value in values[name]], bins=12, color="#a63603", rwidth=0.9)
    axis.set_title(title, fontsize=9)
    axis.tick_params(labelsize=8)
    axis.spines[["top", "right"]].set_visible(False)


if __name__ == "__main__":
    main()
