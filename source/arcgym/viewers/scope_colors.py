# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Color along the scope: material, depth marks and wall force."""

from __future__ import annotations

import numpy as np

from arcgym.viewers.palette import FORCE_TIERS, VISIBLE_FORCE, Tiers, force_colors, to_linear

TABLE_STEP = 0.001
"""Wanted distance between two entries of the color table [m]."""

_SHAFT = to_linear(np.array([44, 48, 58]))
_BENDING = to_linear(np.array([86, 92, 106]))
_TIP = to_linear(np.array([236, 238, 242]))
_MARK = to_linear(np.array([225, 228, 232]))
_TIP_LENGTH = 0.012
_MARK_SPACING = 0.10
_MARK_LENGTH = 0.002


def scope_color_table(
    link_length: np.ndarray,
    bending_links: int,
    force: np.ndarray,
    force_arc: np.ndarray,
    tiers: Tiers = FORCE_TIERS,
) -> np.ndarray:
    """Return the color of the scope at even steps from its proximal end to its tip.

    Dark shaft with a light ring every 10 cm from the tip (as real colonoscopes carry), a lighter bending section and
    a light tip. The tier color of the wall force covers all but the rings where there is any; each place has the force
    of the window around it.

    Args:
        link_length: Length of each link [m], shape (L,).
        bending_links: Number of distal links that form the bending section.
        force: Wall force on each window of the scope [N], shape (K,).
        force_arc: Distance of the middle of each window from the front of the tip [m], ascending, shape (K,).
        tiers: Tiers of the force and their colors.

    Returns:
        Linear RGB, shape (K, 3), where K steps of about 1 mm make up the scope's length.
    """
    ends = np.cumsum(np.asarray(link_length, float))
    count = max(int(round(ends[-1] / TABLE_STEP)), 2)
    arc = (np.arange(count) + 0.5) * ends[-1] / count
    from_tip = ends[-1] - arc
    color = np.where((arc > ends[-1] - np.sum(link_length[len(ends) - bending_links :]))[:, None], _BENDING, _SHAFT)
    color[from_tip < min(_TIP_LENGTH, 0.4 * ends[-1])] = _TIP
    color = _tinted(color, np.interp(from_tip, force_arc, np.asarray(force, float)), tiers)
    is_mark = (from_tip % _MARK_SPACING < _MARK_LENGTH) & (from_tip > 0.5 * _MARK_SPACING)
    color[is_mark] = _MARK
    return color


def _tinted(color: np.ndarray, force: np.ndarray, tiers: Tiers) -> np.ndarray:
    """Blend the tier color in, fully from twenty times the smallest visible force."""
    share = np.clip((force - VISIBLE_FORCE) / (19.0 * VISIBLE_FORCE), 0.0, 1.0)[:, None]
    return color * (1.0 - 0.9 * share) + 0.9 * share * force_colors(force, tiers)
