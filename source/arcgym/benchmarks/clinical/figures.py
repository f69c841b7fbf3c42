# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of insertions that are published of real ones."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.anatomy.segments import SEGMENTS
from arcgym.benchmarks.clinical.record import FIELDS
from arcgym.envs.mdp.shaft_metrics import LOOPS

HIGH_PUSH = 10.0
"""Push whose share of the time is counted [N]; Appleyard et al. 2000."""
INSERTED = 0.60
"""Length of scope at which the place of the tip is noted [m]; Painter et al. 1999."""
LASTING = 1.0
"""Time that a loop has to be there to count [s]; our choice."""
FLEXURE = SEGMENTS.index("splenic")
"""Segment from which on an examiner has straightened the sigmoid colon."""
STEP = 0.1
"""Control step [s]."""
HIGHEST = 0.1
"""Share of the steps, those of the highest mesenteric tension, that stand for demands for pain relief; our choice."""
PLACES = {"sigmoid": ("rectum", "sigmoid"), "descending": ("descending",), "splenic": ("splenic",)} | {
    "transverse": ("transverse",),
    "proximal": ("hepatic", "ascending", "cecum"),
}
"""Places of the tip in Shah et al. 2002 and the segments that we count there."""


@dataclass(frozen=True)
class Insertion:
    """One insertion, by control steps."""

    about: dict[str, Any]
    """Patient, settings and how it ended."""
    steps: np.ndarray
    """Shape (T, F), see :data:`arcgym.benchmarks.clinical.record.FIELDS`."""

    def __getitem__(self, field: str) -> np.ndarray:
        """Return a field of all steps, shape (T,)."""
        return self.steps[:, FIELDS.index(field)]

    @property
    def felt(self) -> np.ndarray:
        """Steps whose forces were measured, shape (T,), bool."""
        return np.asarray(self["went_on"] > 0.5)


def read(folder: Path) -> list[Insertion]:
    """Return the insertions of a folder, by patient; those that were given up at once are left out."""
    found = []
    for path in sorted(folder.glob("*.npz")):
        with np.load(path) as file:
            found.append(Insertion(json.loads(str(file["about"])), file["steps"]))
    return [one for one in found if one.felt.any()]


def figures(insertions: Sequence[Insertion]) -> dict[str, Any]:
    """Return what the table shows of some insertions; None where none gives the figure."""
    arrived = [one for one in insertions if one.about["arrived"]]
    return {
        "insertions": len(insertions),
        "arrived": len(arrived),
        **forces(insertions),
        "place_at_60_cm": places_at(insertions, INSERTED),
        "loops": loops(insertions),
        "gathered": median([ratio_at_end(one) for one in arrived]),
        "shaft_at_cecum": median([float(one["inserted"][-1]) for one in arrived]),
        "gathered_at_furthest": median([ratio_at_end(one) for one in insertions]),
        "gathered_most": median([least_ratio(one) for one in insertions if (one["segment"] >= FLEXURE).any()]),
        "tip_speed": median([speed(one) for one in insertions]),
        "time": median([len(one.steps) * STEP for one in arrived]),
        **demands(insertions),
        "push_by_segment": push_by_segment(insertions),
    }


def forces(insertions: Sequence[Insertion]) -> dict[str, Any]:
    """Return peaks of push, pull and torque over all and their medians, and the share of the time above 10 N."""
    push = [one["push"][one.felt] for one in insertions]
    torque = [one["torque"][one.felt] for one in insertions]
    every = np.abs(np.concatenate(push))
    return {
        "peak_push": float(max(each.max() for each in push)),
        "median_peak_push": median([float(each.max()) for each in push]),
        "peak_pull": float(max(-each.min() for each in push)),
        "time_above_10_N": float((every > HIGH_PUSH).mean()),
        "peak_torque": float(max(each.max() for each in torque)),
        "peak_torque_back": float(max(-each.min() for each in torque)),
    }


def places_at(insertions: Sequence[Insertion], inserted: float) -> dict[str, float] | None:
    """Return the share of insertions by place of the tip when so much scope is first inside [m]; None if none came.

    ``past`` is the splenic flexure or beyond it.
    """
    found = [one["segment"][np.argmax(one["inserted"] >= inserted)] for one in insertions if _comes(one, inserted)]
    if not found:
        return None
    segment, first = np.array(found), {name: SEGMENTS.index(name) for name in ("descending", "splenic")}
    short, past = segment < first["descending"], segment >= first["splenic"]
    shares = {"past": past.mean(), "descending": (~short & ~past).mean(), "sigmoid": short.mean()}
    return {"of": len(found), **{name: float(value) for name, value in shares.items()}}


def _comes(one: Insertion, inserted: float) -> bool:
    return bool((one["inserted"] >= inserted).any())


def loops(insertions: Sequence[Insertion]) -> dict[str, float]:
    """Return the share of insertions with a loop of each kind for a second or longer, and with any."""
    counts = np.array([[(one["loop"] == kind).sum() * STEP for kind in range(1, len(LOOPS))] for one in insertions])
    shares = {name: float((counts[:, k] >= LASTING).mean()) for k, name in enumerate(LOOPS[1:])}
    return {"any": float((counts.sum(axis=1) >= LASTING).mean()), **shares}


def ratio_at_end(one: Insertion) -> float:
    """Return the length of scope inside over that of the colon behind the tip, at rest, where the tip is furthest."""
    furthest = int(np.argmax(one["arc"]))
    return float(one["inserted"][furthest] / one["arc"][furthest])


def least_ratio(one: Insertion) -> float:
    """Return the least of that ratio in any step whose tip is at the splenic flexure or past it."""
    past = one["segment"] >= FLEXURE
    return float((one["inserted"][past] / one["arc"][past]).min())


def speed(one: Insertion) -> float:
    """Return the way of the tip along the colon over the time until it is furthest [m/s]."""
    furthest = int(np.argmax(one["arc"]))
    return float((one["arc"][furthest] - one["arc"][0]) / max(furthest * STEP, STEP))


def demands(insertions: Sequence[Insertion]) -> dict[str, Any]:
    """Return where the tips are, and how often the shaft is looped, in the steps of the highest mesenteric tension."""
    tension, segment, loop = (
        np.concatenate([one[field][one.felt] for one in insertions]) for field in ("mesentery", "segment", "loop")
    )
    high = tension >= np.quantile(tension, 1.0 - HIGHEST)
    codes = {name: [SEGMENTS.index(each) for each in segments] for name, segments in PLACES.items()}
    by_place = {name: float(np.isin(segment[high], code).mean()) for name, code in codes.items()}
    time = {name: float(np.isin(segment, code).mean()) for name, code in codes.items()}
    looped = float((loop[high] > 0.0).mean())
    return {"demands": by_place, "time_by_place": time, "demands_looped": looped, "tension": float(tension[high].min())}


def push_by_segment(insertions: Sequence[Insertion]) -> dict[str, float | None]:
    """Return the median push by segment of the tip [N]; None where no tip was."""
    segment, push = (np.concatenate([one[field][one.felt] for one in insertions]) for field in ("segment", "push"))
    return {name: median(np.abs(push[segment == code]).tolist()) for code, name in enumerate(SEGMENTS)}


def median(values: Sequence[float]) -> float | None:
    """Return the median; None of none."""
    return float(np.median(values)) if len(values) else None
