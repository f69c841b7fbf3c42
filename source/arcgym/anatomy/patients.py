# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark's patients, after the clinical descriptions in the ARCGym paper (RA-L 2026)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from .spec import ColonSpec, default_segments


def colon_1() -> ColonSpec:
    """Man of 65: slightly redundant, sharply angulated sigmoid; diverticula in the descending colon."""
    segments = default_segments()
    segments["sigmoid"] = replace(segments["sigmoid"], length=0.55)
    segments["descending"] = replace(segments["descending"], diverticula=12)
    segments["transverse"] = replace(segments["transverse"], polyps=1)
    segments["sigmoid"] = replace(segments["sigmoid"], polyps=1)
    return ColonSpec(
        name="colon_1",
        patient="man, 65 years: slightly redundant sigmoid with sharp angulations, descending diverticula; supine",
        seed=3,
        segments=segments,
        sigmoid_shape="angulated",
    )


PATIENTS: dict[str, Callable[[], ColonSpec]] = {"colon_1": colon_1}
"""Spec of each committed colon by folder name."""
