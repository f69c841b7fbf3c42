# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Room for a scope's stiff head in a generated colon: where it does not pass, it is drawn into the lumen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from arcgym.anatomy.generator.fitting import LEG_GAP, fit_surface
from arcgym.anatomy.generator.lesions import Lesion
from arcgym.anatomy.generator.lumen_field import FieldGrid
from arcgym.anatomy.generator.surface import Surface
from arcgym.anatomy.head_drawing import draw_heads
from arcgym.anatomy.meshing.colon_fitting import FittedColon
from arcgym.anatomy.validation.passage import HEAD_RADIUS, Passage, contact_passage, wall_passage
from arcgym.anatomy.voxel_grid import Grid

SPARED = 0.0015, 0.0015, 0.0020, 0.0030
"""What the drawn head is thicker than the scopes', in turn [m]: wall and contact surface smooth a narrow lumen over, so
that seeds 10060 and 10075 needed one fit more with 1 mm."""


class NoRoomError(ValueError):
    """The head does not pass, however much the lumen was widened."""


def passage_of(fitted: FittedColon) -> Passage:
    """Return the room for the head in the contact surface; where it passes, as much as was found until then."""
    return contact_passage(fitted.contact, fitted.centerline, until=HEAD_RADIUS)


def passage_in_wall(fitted: FittedColon) -> Passage:
    """Return the same in the wall's inner layer, whose faces the scope touches unless it is told otherwise."""
    line = fitted.centerline
    return wall_passage(fitted.wall, line.points.astype(float), line.arc.astype(float), until=HEAD_RADIUS)


def fit_with_room(
    surface: Surface, lesions: Sequence[Lesion], lumen: FieldGrid, fitted: FittedColon
) -> tuple[FittedColon, float]:
    """Return a colon through which the head passes: the given one where it does, else one of a widened lumen.

    It has to pass in both of what a scope may touch: the contact surface and the wall's inner layer.

    Args:
        surface: The colon.
        lesions: Its lesions.
        lumen: Its lumen.
        fitted: The colon as it was fitted to that.

    Returns:
        The colon, and the volume that was added to its lumen [m^3].

    Raises:
        NoRoomError: The head does not pass in a widened lumen either; says where.
        ValueError: The widened lumen gives no wall.
    """
    before, passages = lumen, _passages(fitted)
    if _least(passages) >= HEAD_RADIUS:
        return fitted, 0.0
    for spared in SPARED:
        for found in passages:
            lumen = widened(lumen, surface, found, HEAD_RADIUS + spared)
        fitted = fit_surface(surface, lesions, lumen)
        passages = _passages(fitted)
        if _least(passages) >= HEAD_RADIUS:
            added = (lumen.values > 0.0).sum() - (before.values > 0.0).sum()
            return fitted, float(added) * lumen.spacing**3
    found = min(passages, key=lambda one: one.least)
    raise NoRoomError(
        f"a stiff head has room for {1e3 * found.least:.1f} mm at {found.tightest:.3f} m, expected"
        f" {1e3 * HEAD_RADIUS:.1f} mm, however much the lumen is widened"
    )


def _passages(fitted: FittedColon) -> list[Passage]:
    return [passage_of(fitted), passage_in_wall(fitted)]


def _least(passages: Sequence[Passage]) -> float:
    return min(found.least for found in passages)


def widened(lumen: FieldGrid, surface: Surface, found: Passage, radius: float) -> FieldGrid:
    """Return a lumen into which the head is drawn where it lacks room, and nothing else changes.

    Args:
        lumen: The lumen.
        surface: The colon it is of.
        found: Heads in the poses in which they have most room.
        radius: Radius with which they are drawn [m].
    """
    share = np.clip(0.5 + lumen.values / lumen.spacing, 0.0, 1.0)
    before = Grid(share, lumen.origin, lumen.spacing)
    out = Grid(share.copy(), lumen.origin, lumen.spacing)
    poor = np.flatnonzero(found.room < HEAD_RADIUS)
    draw_heads(out, before, surface.curve.points, found, poor, radius, 2 * surface.spec.wall_thickness + LEG_GAP)
    drawn = out.values > share
    values = lumen.values.copy()
    values[drawn] = (out.values[drawn] - 0.5) * lumen.spacing
    return FieldGrid(values, lumen.origin, lumen.spacing)
