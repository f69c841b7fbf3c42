# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Colors and force tiers that every picture of the package shares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arcgym.anatomy.segments import SEGMENTS
from arcgym.assets.force_tiers import ForceTiersCfg


@dataclass(frozen=True)
class ForceTier:
    """One range of wall force and how it is shown."""

    start: float
    """Lowest force of the tier [N]."""
    label: str
    """Meaning of the tier, for the legend."""
    color: tuple[int, int, int]
    """Display color (sRGB, 0..255)."""


Tiers = Sequence[ForceTier]
"""Ascending tiers, the first of which starts at zero."""


def shown_tiers(limits: ForceTiersCfg) -> Tiers:
    """Return the tiers between the limits of a task, with the colors of their pictures."""
    return (
        ForceTier(0.0, "comfort", (66, 184, 131)),
        ForceTier(limits.comfort, "discomfort", (245, 190, 40)),
        ForceTier(limits.unsafe, "unsafe", (238, 84, 42)),
        ForceTier(limits.perforation, "perforation", (190, 24, 160)),
    )


FORCE_TIERS = shown_tiers(ForceTiersCfg())
"""Tiers of the default limits."""

VISIBLE_FORCE = 0.05
"""Wall force from which a link is colored at all [N]."""

SEGMENT_COLORS: dict[str, tuple[int, int, int]] = dict(
    zip(
        SEGMENTS,
        (
            (224, 122, 116),
            (240, 164, 92),
            (236, 204, 92),
            (120, 200, 140),
            (98, 176, 222),
            (134, 140, 222),
            (192, 130, 206),
            (150, 160, 172),
        ),
        strict=True,
    )
)
"""Display color of each colon segment (sRGB, 0..255)."""

_DEFORMATION_STOPS = np.array(
    [[238, 158, 140], [236, 204, 158], [146, 206, 180], [60, 158, 190], [38, 96, 176], [52, 40, 120]], float
)


def force_tier(force: float, tiers: Tiers = FORCE_TIERS) -> ForceTier:
    """Return the tier that a wall force [N] belongs to."""
    return [tier for tier in tiers if force >= tier.start or tier is tiers[0]][-1]


def force_colors(force: np.ndarray, tiers: Tiers = FORCE_TIERS) -> np.ndarray:
    """Return the color of each force.

    Colors change from one tier to the next over 10 % of the threshold, so that a tier reads as one color.

    Args:
        force: Wall force [N], shape (K,).
        tiers: Tiers and their colors.

    Returns:
        Linear RGB in 0..1, shape (K, 3).
    """
    knots, colors = [0.0], [tiers[0].color]
    for below, tier in zip(tiers, tiers[1:], strict=False):
        knots += [0.9 * tier.start, tier.start]
        colors += [below.color, tier.color]
    return _ramp(np.asarray(force, float), np.array(knots), to_linear(np.array(colors)))


def deformation_colors(fraction: np.ndarray) -> np.ndarray:
    """Return the wall's color from undeformed (0, tissue) to the end of the scale (1, deep blue).

    The ramp runs through cool colors: warm ones belong to the forces on the scope.

    Args:
        fraction: Displacement over the full scale, shape (K,).

    Returns:
        Linear RGB in 0..1, shape (K, 3).
    """
    knots = np.linspace(0.0, 1.0, len(_DEFORMATION_STOPS))
    return _ramp(np.clip(fraction, 0.0, 1.0), knots, to_linear(_DEFORMATION_STOPS))


def to_linear(color: np.ndarray) -> np.ndarray:
    """Convert sRGB 0..255 to linear 0..1 with a gamma of 2.2."""
    return (np.asarray(color, float) / 255.0) ** 2.2


def to_display(color: np.ndarray) -> np.ndarray:
    """Convert linear 0..1 to sRGB uint8 with a gamma of 2.2."""
    return (255.0 * np.clip(color, 0.0, 1.0) ** (1.0 / 2.2) + 0.5).astype(np.uint8)


def _ramp(value: np.ndarray, knots: np.ndarray, colors: np.ndarray) -> np.ndarray:
    return np.stack([np.interp(value, knots, colors[:, channel]) for channel in range(3)], axis=-1)
