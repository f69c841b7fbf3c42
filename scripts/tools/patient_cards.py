#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measure the shipped patients and write cards with pictures into ``docs/patients.md`` between its two marks."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from arcgym.anatomy import ColonStage

ROOT = Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- cards -->", "<!-- end of cards -->"
SCANNED = ("ct_1", "ct_2")
"""Colons that were imported from CT."""
PICTURED = ("colon_1", "colon_2", *SCANNED)
"""Colons with a picture in the repository; the others would be alike, and there is no room for them."""


def main() -> None:
    """Parse the command line and writes the cards."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--no-pictures", action="store_true", help="write the tables only")
    parser.add_argument("--pictures", nargs="+", metavar="NAME", help="patients to draw (default: those on the page)")
    args = parser.parse_args()
    from arcgym.anatomy import read_colon
    from arcgym.anatomy.generator.patients import PATIENTS
    from arcgym.viewers.colon_page import draw_page

    cards = []
    for name in (*PATIENTS, *SCANNED):
        stage = read_colon(ROOT / "assets" / "usd" / name / "colon.usda")
        cards.append(card(name, stage))
        if not args.no_pictures and name in (args.pictures or PICTURED):
            draw_page(stage).save(
                ROOT / "docs" / "images" / "patients" / f"{name}.jpg", quality=66, optimize=True, progressive=True
            )
        print(name, flush=True)
    page = ROOT / "docs" / "patients.md"
    before, rest = page.read_text().split(BEGIN)
    after = rest.split(END)[1]
    page.write_text(f"{before}{BEGIN}\n\n" + "\n".join(cards) + f"\n{END}{after}")


def card(name: str, stage: ColonStage) -> str:
    """Return one patient's card as Markdown."""
    kind, number = name.split("_")
    patient = str(stage.metadata["patient"])
    rows = ["| Segment | Length [cm] | Diameter p5 / p50 / p95 [mm] |", "|---|---|---|"]
    for segment, (start, end) in stage.segment_bounds().items():
        rows.append(f"| {segment} | {100 * (end - start):.1f} | {diameters(stage, start, end)} |")
    rows.append(f"| whole | {100 * stage.length:.0f} | {diameters(stage, 0.0, stage.length)} |")
    title = f"## {'CT' if kind == 'ct' else 'Colon'} {number}\n\n{patient[0].upper() + patient[1:]}."
    made = f"Its picture: `arcgym preview {name} {name}.jpg`."
    picture = f"![{name}](images/patients/{name}.jpg)" if name in PICTURED else made
    last = scanned_features(stage) if name in SCANNED else features(name, stage)
    return f"{title}\n\n{picture}\n\n" + "\n".join(rows) + f"\n\n{last}\n"


def diameters(stage: ColonStage, start: float, end: float) -> str:
    """Return three percentiles of the lumen diameter between folds [mm]."""
    import numpy as np

    line = stage.centerline
    part = 2e3 * line.radius[(line.arc >= start) & (line.arc <= end)]
    return " / ".join(f"{value:.0f}" for value in np.quantile(part, [0.05, 0.5, 0.95]))


def features(name: str, stage: ColonStage) -> str:
    """Return a sentence with the number of bends, folds and lesions, and the least bend radius."""
    from arcgym.anatomy.course_measures import measure_course
    from arcgym.anatomy.generator.generate import draw_surface
    from arcgym.anatomy.generator.lesions import WIDE_NECK
    from arcgym.anatomy.generator.patients import PATIENTS

    surface, lesions = draw_surface(PATIENTS[name](), int(stage.metadata.get("attempt", 0)))
    polyps = sum(lesion.kind in ("sessile", "pedunculated", "flat") for lesion in lesions)
    sacs = [lesion for lesion in lesions if lesion.kind == "diverticulum"]
    wide = sum(lesion.size >= WIDE_NECK for lesion in sacs)
    measured = measure_course(stage.centerline.points.astype(float))
    sharpest, folds = 1e3 * measured.bend_radius_least, sum(len(row.s) for row in surface.rows)
    return (
        f"{measured.acute_bends} acute bends (least radius {sharpest:.0f} mm), {folds} semilunar folds,"
        f" {len(surface.valves)} rectal valves, ileocecal valve and appendix orifice,\n{polyps} polyps,"
        f" {len(sacs)} diverticula, {wide} of them wide enough for a 13 mm tip."
    )


def scanned_features(stage: ColonStage) -> str:
    """Return sentences with the bends of a colon from CT and where it comes from."""
    from arcgym.anatomy.course_measures import measure_course

    measured = measure_course(stage.centerline.points.astype(float))
    sharpest = 1e3 * measured.bend_radius_least
    return f"{measured.acute_bends} acute bends (least radius {sharpest:.0f} mm). {stage.metadata['licence']}."


if __name__ == "__main__":
    main()
