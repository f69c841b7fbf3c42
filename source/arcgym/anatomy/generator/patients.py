# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark's patients, after the clinical descriptions in the ARCGym paper (RA-L 2026)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from arcgym.anatomy.generator.spec import ColonSpec, PolypSpec, SegmentSpec, default_segments
from arcgym.anatomy.mucosa.spec import MucosaSpec


def colon_1() -> ColonSpec:
    """Return the man of 65: slightly redundant, sharply angulated sigmoid; diverticula in the descending colon."""
    segments = default_segments()
    segments["sigmoid"] = replace(segments["sigmoid"], length=0.55)
    segments["descending"] = replace(segments["descending"], diverticula=12)
    segments["transverse"] = replace(segments["transverse"], polyps=1)
    segments["sigmoid"] = replace(segments["sigmoid"], polyps=1)
    return _committed(
        ColonSpec(
            name="colon_1",
            patient="man, 65 years: slightly redundant sigmoid with sharp angulations, descending diverticula; supine",
            seed=3,
            course="colon_1",
            segments=segments,
            sigmoid_shape="angulated",
            acute_bends=10,
        )
    )


def colon_2() -> ColonSpec:
    """Return the man of colon 3, prone: the same wall, its mobile segments pressed back by the table."""
    return replace(
        colon_3(),
        name="colon_2",
        course="colon_2",
        patient="man, 51 years: redundant transverse colon, no polyps; prone (the patient of colon_3)",
        posture="prone",
    )


def colon_3() -> ColonSpec:
    """Return the man of 51, supine: redundant transverse colon that hangs into the pelvis, no polyps."""
    segments = _with_lengths(sigmoid=0.45, descending=0.205, transverse=0.56, ascending=0.145)
    return _committed(
        ColonSpec(
            name="colon_3",
            patient="man, 51 years: redundant transverse colon, no polyps; supine (the patient of colon_2)",
            seed=3,
            first_attempt=1,
            course="colon_3",
            segments=segments,
            sigmoid_shape="angulated",
            acute_bends=11,
            transverse_sag=0.17,
            mucosa=MucosaSpec(paleness=0.62, redness=0.12, vessels=1.15),
        )
    )


def colon_4() -> ColonSpec:
    """Return the woman of 51: narrow colon, sigmoid and transverse redundant with many sharp bends, no lesions."""
    lengths = _with_lengths(rectum=0.14, sigmoid=0.70, descending=0.21, transverse=0.57, ascending=0.135)
    diameters = {
        "rectum": (0.025, 0.048),
        "sigmoid": (0.032, 0.032),
        "descending": (0.033, 0.035),
        "splenic": (0.035, 0.035),
        "transverse": (0.036, 0.037),
        "hepatic": (0.038, 0.040),
        "ascending": (0.046, 0.050),
    }
    for name, (start, middle) in diameters.items():
        lengths[name] = replace(lengths[name], start_diameter=start, middle_diameter=middle)
    return _committed(
        ColonSpec(
            name="colon_4",
            patient="woman, 51 years: highly redundant sigmoid and transverse colon, many sharp bends; supine",
            seed=1,
            course="colon_4",
            segments=lengths,
            sigmoid_shape="redundant",
            transverse_shape="redundant",
            acute_bends=14,
            min_bend_radius=0.013,
            transverse_sag=0.13,
            mucosa=MucosaSpec(paleness=0.35, redness=0.12, vessels=1.35),
        )
    )


def colon_5() -> ColonSpec:
    """Man of 60: 16 polyps, diverticula left and right, redundant sigmoid, residual stool."""
    segments = _with_lengths(sigmoid=0.63, descending=0.205, transverse=0.39, ascending=0.145)
    segments["descending"] = replace(segments["descending"], diverticula=15, wide_diverticula=2)
    segments["ascending"] = replace(segments["ascending"], diverticula=10, wide_diverticula=2)
    return _committed(
        ColonSpec(
            name="colon_5",
            patient="man, 60 years: 16 polyps, ascending and descending diverticula, redundant sigmoid, residual stool;"
            " supine",
            seed=0,
            course="colon_5",
            segments=segments,
            sigmoid_shape="looped",
            acute_bends=11,
            polyp_list=COLON_5_POLYPS,
            mucosa=MucosaSpec(paleness=0.40, redness=0.34, vessels=0.8, stool=0.12),
        )
    )


COLON_5_POLYPS = (
    *(PolypSpec(name, 0.004, "Is") for name in ("rectum", "sigmoid", "transverse", "ascending")),
    *(PolypSpec(name, 0.005, "IIa") for name in ("sigmoid", "descending", "transverse", "hepatic")),
    *(PolypSpec(name, 0.007, "Is") for name in ("sigmoid", "transverse", "ascending")),
    PolypSpec("descending", 0.008, "Ip"),
    PolypSpec("transverse", 0.009, "IIa"),
    PolypSpec("sigmoid", 0.012, "Ip"),
    PolypSpec("transverse", 0.010, "Is"),
    PolypSpec("ascending", 0.015, "IIa"),
)
"""Eight diminutive (to 5 mm), five small (6-9 mm) and three large polyps (10 mm and more)."""


def _with_lengths(**lengths: float) -> dict[str, SegmentSpec]:
    """Return the default segments with some lengths changed [m]."""
    segments = default_segments()
    return segments | {name: replace(segments[name], length=length) for name, length in lengths.items()}


def _committed(spec: ColonSpec) -> ColonSpec:
    """Make files of less than 5 MB, as the repository holds them all, not of 7; with the cecum that they have."""
    return replace(
        spec,
        closed_cecum=False,
        visual_refinements=2,
        mucosa=replace(spec.mucosa, width=512),
    )


PATIENTS: dict[str, Callable[[], ColonSpec]] = {
    make.__name__: make for make in (colon_1, colon_2, colon_3, colon_4, colon_5)
}
"""Spec of each committed colon by folder name."""
