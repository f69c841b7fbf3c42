# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The table of scripted insertions beside published ones."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from arcgym.benchmarks.clinical.figures import figures, read

Figures = dict[str, Any]
"""What :func:`arcgym.benchmarks.clinical.figures.figures` returns."""
APPLEYARD = "Appleyard et al. 2000, 21 examinations"
PAINTER = "Painter et al. 1999, 136 examinations"
SHAH = "Shah et al. 2002, 650 demands"
"""Studies whose figures the insertions stand beside."""


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{100.0 * value:.0f} %"


def _number(value: float | None, digits: int = 1, unit: str = "") -> str:
    return "–" if value is None else f"{value:.{digits}f}{unit}"


def _places(figures: Figures) -> str:
    place = figures["place_at_60_cm"]
    if place is None:
        return "–"
    return f"{_percent(place['past'])}, {_percent(place['descending'])}, {_percent(place['sigmoid'])} of {place['of']}"


def _shares(shares: Mapping[str, float]) -> str:
    return ", ".join(f"{100.0 * value:.0f}" for value in shares.values()) + " %"


ROWS: tuple[tuple[str, str, str, Callable[[Figures], str]], ...] = (
    ("Insertions; cecum entered", "93–98 %", "usual rates", lambda f: f"{f['insertions']}; {_share_arrived(f)}"),
    ("Peak push, pull [N]", "43, 18", APPLEYARD, lambda f: f"{f['peak_push']:.0f}, {f['peak_pull']:.0f}"),
    ("Push or pull over 10 N", "5 % of the time", APPLEYARD, lambda f: _percent(f["time_above_10_N"])),
    (
        "Peak torque, one way and the other [N m]",
        "1.0, 0.8",
        APPLEYARD,
        lambda f: f"{f['peak_torque']:.2f}, {f['peak_torque_back']:.2f}",
    ),
    ("Tip at 60 cm: splenic flexure or past, descending, sigmoid or rectum", "29 %, 9 %, 62 %", PAINTER, _places),
    ("Any loop", "91 %", "Shah et al. 2000", lambda f: _percent(f["loops"]["any"])),
    ("N loop", "79 %", "Shah et al. 2000", lambda f: _percent(f["loops"]["n"])),
    (
        "Scope inside over length of colon, in the cecum",
        "0.56",
        "Schlott et al., 2 × 100",
        lambda f: _number(f["gathered"], 2),
    ),
    (
        "The same where the tip got furthest",
        "–",
        "for insertions that did not arrive",
        lambda f: _number(f["gathered_at_furthest"], 2),
    ),
    (
        "The least of it, tip at the splenic flexure or past",
        "–",
        "after a pull",
        lambda f: _number(f["gathered_most"], 2),
    ),
    (
        "Scope inside in the cecum [cm]",
        "70–90",
        "usual, straight",
        lambda f: _number(None if f["shaft_at_cecum"] is None else 100.0 * f["shaft_at_cecum"], 0),
    ),
    (
        "Time to the cecum [min]",
        "4–11",
        "experts, usual",
        lambda f: _number(None if f["time"] is None else f["time"] / 60.0, 1),
    ),
    ("Mean speed of the tip [mm/s]", "2–6", "derived", lambda f: _number(1000.0 * f["tip_speed"], 0)),
    (
        "Highest mesenteric tension, tip in sigmoid, descending, splenic flexure, transverse, beyond",
        "77, 7, 6, 5, 4 %",
        SHAH + " for pain relief",
        lambda f: _shares(f["demands"]),
    ),
    ("The same, shaft looped", "79 %", SHAH, lambda f: _percent(f["demands_looped"])),
    (
        "Median push or pull, tip in rectum, sigmoid, ... cecum [N]",
        "rises",
        "Korman et al. 2012",
        lambda f: ", ".join(_number(value, 0) for value in f["push_by_segment"].values()),
    ),
)
"""Name, published figure, source, and our figure in words."""


def _share_arrived(figures: Figures) -> str:
    return _percent(figures["arrived"] / figures["insertions"])


def write_table(folder: Path) -> str:
    """Write ``figures.json`` and ``table.md`` of all variants in a folder, and return the table.

    Raises:
        ValueError: If there are no insertions.
    """
    insertions = {path.name: read(path) for path in sorted(folder.iterdir()) if path.is_dir()}
    found = {name: figures(those) for name, those in insertions.items() if those}
    if not found:
        raise ValueError(f"there are no insertions in {folder}; leave --table away to make them.")
    (folder / "figures.json").write_text(json.dumps(found, indent=1) + "\n")
    text = table(found)
    (folder / "table.md").write_text(text + "\n")
    return text


def table(found: Mapping[str, Figures]) -> str:
    """Return the Markdown table of the figures by variant."""
    heads = ["", "Published", *(f"`{name}`" for name in found), "Source"]
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    for name, published, source, say in ROWS:
        cells = [name, published, *(say(figures) for figures in found.values()), source]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)
