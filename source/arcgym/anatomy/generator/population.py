# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Random patients after published statistics of the adult colon on CT colonography."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from arcgym.anatomy.generator.spec import CollapseSpec, ColonSpec
from arcgym.anatomy.mucosa.spec import MucosaSpec
from arcgym.anatomy.segments import SEGMENTS

LENGTH_MEAN = {"woman": 1.933, "man": 1.854}
"""Mean length of the colon [m], n = 505 (Khashab et al., Endoscopy 2009)."""

LENGTH_DEVIATION = 0.260
"""Standard deviation of the length within a sex [m]; over both it is 0.263 (Khashab et al.)."""

WOMEN = 0.52
"""Share of women: that at which both means make the overall one, 1.895 m (Khashab et al.)."""

LENGTH_RANGE = 1.37, 2.42
"""Lengths that are drawn [m]: the mean and two standard deviations; 5 % of people lie beyond."""

BENDS_MEAN, BENDS_DEVIATION = 10.9, 2.4
"""Number of acute-angle flexures (Khashab et al.)."""

REGULAR_BENDS, LONG_BENDS = 9.6, 11.9
"""Mean number of acute-angle flexures in colons with complete and incomplete colonoscopy (Hanson et al., AJR 2007)."""

BENDS_RANGE = 5, 16
"""Numbers of acute bends that are drawn."""

REGULAR_LENGTH, LONG_LENGTH = 1.670, 2.108
"""Mean length of colons with complete and with incomplete colonoscopy [m] (Hanson et al., AJR 2007)."""

REGULAR_SIGMOID, LONG_SIGMOID = 0.487, 0.668
"""Mean length of the sigmoid in the two groups [m] (Hanson et al.)."""

REGULAR_TRANSVERSE, LONG_TRANSVERSE = 0.492, 0.663
"""Mean length of the transverse colon in the two groups, flexures included by halves [m] (Hanson et al.)."""

DIVERTICULA_PREVALENCE, DIVERTICULA_MEAN = 0.42, 14.0
"""Share of people with diverticula, and their mean number in those (Peery et al., CGH 2016)."""

DIVERTICULA_SITES = {"sigmoid": 0.75, "descending": 0.11, "transverse": 0.06, "ascending": 0.08}
"""Where diverticula are (Peery et al.)."""

DESCENDING_LENGTH, ASCENDING_LENGTH = 0.215, 0.145
"""Lengths of descending and ascending colon that the frame of :mod:`arcgym.anatomy.generator.courses` has room for [m]:
a longer one needs a higher flexure, as both run straight up the flank from the iliac fossa."""

ILIAC_FOSSA = 0.180
"""Height above the anal verge at which the descending colon of random patients ends [m]: in the left iliac fossa, a
little below the iliac crest (Standring, Gray's Anatomy), as in the five patients (0.175 to 0.187)."""

WIDTH_MEAN, WIDTH_DEVIATION, WIDTH_RANGE = 0.88, 0.11, (0.68, 1.12)
"""Diameters over the default's. Five colons from CT, imported, have medians of 28 to 44 mm and 5th percentiles of 21 to
31 mm; the default's are 42 and 33 mm."""

LEAST_WIDTH = {"rectum": 0.9, "ascending": 0.95, "cecum": 0.95}
"""Least factor of the diameters of single segments: gas rises into the widest; from CT the 95th percentile of diameters
is 55 to 63 mm whatever the median."""

WAVES_MEAN, WAVES_DEVIATION, WAVES_RANGE = 0.0025, 0.0004, (0.0015, 0.0035)
"""Size of the waves of the course [m]: with it the total turning is that of colons from CT."""

MYOCHOSIS_SHARE = 0.5
"""Share of people with diverticula whose sigmoid is diverticular: advanced disease is seen in 22 % of colonoscopies
(Hanson et al., AJR 2007), half of the 42 % who have diverticula."""

SPASTIC_SHARE = 0.10
"""Share of the others whose sigmoid is in spasm; our choice."""

COLLAPSED_MEAN = 0.7
"""Mean number of collapsed stretches: 4 to 12 % of the segments are distended poorly on CT colonography (n = 146)."""

COLLAPSING = {"sigmoid": 0.5, "descending": 0.25, "transverse": 0.15, "ascending": 0.10}
"""Where they are; our choice: the sigmoid is the segment that is distended worst."""

_MOST_DIVERTICULA = 24
"""Largest number of diverticula that are drawn."""

_LONG_TRANSVERSE = 0.56
"""Length from which a transverse colon takes the redundant course [m]."""


def draw_spec(seed: int) -> ColonSpec:
    """Draw one patient; the same seed always gives the same spec."""
    rng = np.random.default_rng([seed, 2009])
    sex = str(rng.choice(["woman", "man"], p=[WOMEN, 1.0 - WOMEN]))
    total = draw_length(rng, sex)
    lengths = segment_lengths(total)
    default = ColonSpec()
    diverticula = _draw_diverticula(rng)
    width = float(np.clip(rng.normal(WIDTH_MEAN, WIDTH_DEVIATION), *WIDTH_RANGE))
    segments = {}
    for name in SEGMENTS:
        base = default.segments[name]
        scale = max(width, LEAST_WIDTH.get(name, 0.0))
        segments[name] = replace(
            base,
            length=round(lengths[name], 4),
            start_diameter=round(base.start_diameter * scale, 4),
            middle_diameter=round(base.middle_diameter * scale, 4),
            diverticula=diverticula.get(name, 0),
            polyps=int(rng.random() < 0.15),
        )
    return replace(
        default,
        name=f"patient_{seed}",
        patient=f"random {sex}, seed {seed}, {total:.2f} m; supine",
        seed=seed,
        segments=segments,
        sigmoid_shape=_draw_sigmoid(rng, lengths["sigmoid"]),
        transverse_shape="plain" if lengths["transverse"] < _LONG_TRANSVERSE else "redundant",
        iliac_fossa=ILIAC_FOSSA,
        left_rise=round(lengths["descending"] - DESCENDING_LENGTH, 4),
        right_rise=round(lengths["ascending"] - ASCENDING_LENGTH, 4),
        transverse_sag=float(np.clip(0.10 + 0.45 * (lengths["transverse"] - 0.40), 0.07, 0.17)),
        acute_bends=draw_bends(rng, total),
        mucosa=MucosaSpec(paleness=rng.uniform(0.3, 0.6), redness=rng.uniform(0.1, 0.3), vessels=rng.uniform(0.7, 1.3)),
        waviness=round(float(np.clip(rng.normal(WAVES_MEAN, WAVES_DEVIATION), *WAVES_RANGE)), 5),
        sigmoid_state=_draw_state(rng, bool(diverticula)),
        collapsed=_draw_collapsed(rng),
    )


def draw_length(rng: np.random.Generator, sex: str) -> float:
    """Draw the length of a colon [m] from the sex's normal distribution, cut to :data:`LENGTH_RANGE`."""
    while True:
        length = float(rng.normal(LENGTH_MEAN[sex], LENGTH_DEVIATION))
        if LENGTH_RANGE[0] <= length <= LENGTH_RANGE[1]:
            return length


def draw_bends(rng: np.random.Generator, length: float) -> int:
    """Draw the number of acute bends: more in longer colons, as between Hanson's groups; over all as Khashab found."""
    per_meter = (LONG_BENDS - REGULAR_BENDS) / (LONG_LENGTH - REGULAR_LENGTH)
    explained = per_meter * LENGTH_DEVIATION
    mean = BENDS_MEAN + per_meter * (length - np.mean(list(LENGTH_MEAN.values())))
    count = rng.normal(mean, np.sqrt(BENDS_DEVIATION**2 - explained**2))
    return int(np.clip(round(count), *BENDS_RANGE))


def segment_lengths(total: float) -> dict[str, float]:
    """Return the length of each segment [m]: sigmoid and transverse on the line through Hanson's two groups.

    Rectum, cecum and flexures, which are bends, are the default spec's; descending and ascending colon share the rest
    in its proportions.
    """
    share = (total - REGULAR_LENGTH) / (LONG_LENGTH - REGULAR_LENGTH)
    default = {name: segment.length for name, segment in ColonSpec().segments.items()}
    halves = 0.5 * (default["splenic"] + default["hepatic"])
    lengths = {
        "sigmoid": REGULAR_SIGMOID + share * (LONG_SIGMOID - REGULAR_SIGMOID),
        "transverse": REGULAR_TRANSVERSE + share * (LONG_TRANSVERSE - REGULAR_TRANSVERSE) - halves,
    }
    lengths |= {name: default[name] for name in ("rectum", "splenic", "hepatic", "cecum")}
    rest = [name for name in SEGMENTS if name not in lengths]
    scale = (total - sum(lengths.values())) / sum(default[name] for name in rest)
    return {name: lengths[name] if name in lengths else default[name] * scale for name in SEGMENTS}


def _draw_sigmoid(rng: np.random.Generator, length: float) -> str:
    if length > 0.62:
        return "redundant"
    return str(rng.choice(("plain", "angulated") if length < 0.55 else ("angulated", "looped")))


def _draw_state(rng: np.random.Generator, diverticula: bool) -> str:
    """Draw the sigmoid's state: of people with diverticula some have thick muscle, of all some a spasm."""
    thick, spasm = rng.random(2)
    if diverticula and thick < MYOCHOSIS_SHARE:
        return "diverticular"
    return "spastic" if spasm < SPASTIC_SHARE else "relaxed"


def _draw_collapsed(rng: np.random.Generator) -> tuple[CollapseSpec, ...]:
    """Draw stretches that gas does not hold open."""
    count = min(int(rng.poisson(COLLAPSED_MEAN)), len(COLLAPSING))
    places = rng.choice(list(COLLAPSING), size=count, replace=False, p=list(COLLAPSING.values()))
    return tuple(
        CollapseSpec(
            segment=str(place),
            position=round(rng.uniform(0.25, 0.75), 3),
            length=round(rng.uniform(0.03, 0.10), 4),
            diameter=round(rng.uniform(0.017, 0.026), 4),
        )
        for place in places
    )


def _draw_diverticula(rng: np.random.Generator) -> dict[str, int]:
    if rng.random() > DIVERTICULA_PREVALENCE:
        return {}
    count = min(int(rng.geometric(1.0 / DIVERTICULA_MEAN)), _MOST_DIVERTICULA)
    sites = rng.choice(list(DIVERTICULA_SITES), size=count, p=list(DIVERTICULA_SITES.values()))
    return {str(site): int((sites == site).sum()) for site in np.unique(sites)}
