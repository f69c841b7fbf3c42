# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pieces beside a gap whose ends are taken for corners, and ends of the path that are taken for small bowel."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.anatomy.importing.bridging import Piece, Tip, join_pieces
from arcgym.anatomy.importing.cecal_end import without_small_bowel
from arcgym.anatomy.importing.tree import LumenTree

LINE = np.arange(0.0, 0.045, 0.005)


def cut_beside_a_pocket(label: int, at: float, towards: float, volume: float = 1e-4) -> Piece:
    """A tube along X, cut at ``at`` [m]; its only tip is the bottom of a pocket 15 mm behind the cut, 40 mm deep."""
    inside = at - 0.015 * towards
    bottom = np.array([inside, 0.0, -0.04 * towards])
    face = np.array([[at, 0.012 * np.cos(angle), 0.012 * np.sin(angle)] for angle in np.arange(0.0, 6.0)])
    down = np.stack([np.full_like(LINE, inside), 0 * LINE, -towards * LINE[::-1]], 1)
    back = np.stack([inside - towards * LINE, 0 * LINE, 0 * LINE], 1)
    tip = Tip(
        point=bottom,
        direction=np.array([0.0, 0.0, -towards]),
        room=0.003,
        radius=0.01,
        surface=np.concatenate([[[at, 0.0, 0.0], bottom], face]),
        way=np.concatenate([down, back]),
    )
    return Piece(label, volume, back[-1], 0.3, [tip])


def test_gap_is_bridged_where_the_pieces_were_cut() -> None:
    """28 mm apart, while tips look past each other: 0 facing -0.8; the bridge leads from middle to middle."""
    pieces = [cut_beside_a_pocket(1, 0.0, 1.0), cut_beside_a_pocket(2, 0.028, -1.0)]
    kept, (bridge,) = join_pieces(pieces, 0.05)
    assert kept == pieces
    assert bridge.start == pytest.approx([-0.015, 0.0, 0.0])
    assert bridge.end == pytest.approx([0.043, 0.0, 0.0])


def test_sides_of_small_pieces_are_not_matched() -> None:
    """What is left out of less than a tenth of the lumen may be no colon."""
    pieces = [cut_beside_a_pocket(1, 0.0, 1.0), cut_beside_a_pocket(2, 0.028, -1.0, volume=1e-5)]
    assert join_pieces(pieces, 0.05) == (pieces[:1], [])


def test_end_that_narrows_is_no_small_bowel() -> None:
    """The last 6 cm of a lumen of 25 mm radius narrow to 10 mm; where they begin, small bowel leaves, first 18 mm."""
    colon = np.stack([np.arange(0.0, 1.0, 0.002), np.zeros(500), np.zeros(500)], 1)
    bowel = np.stack([np.full(80, 0.94), np.arange(0.002, 0.162, 0.002), np.zeros(80)], 1)
    narrowing = np.linspace(0.025, 0.010, 30)
    clearance = np.concatenate([np.full(470, 0.025), narrowing, np.full(10, 0.018), np.full(70, 0.008)])
    parent = np.concatenate([[0], np.arange(499), [470], np.arange(500, 579)])
    points = np.concatenate([colon, bowel])
    tree = LumenTree(points, parent, clearance, clearance, [0, 499, 579], points, 0.002)
    nodes, cut = without_small_bowel(tree, tree.between(0, 499))
    assert nodes[-1] == 499
    assert cut == []
