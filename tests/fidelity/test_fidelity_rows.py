# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rows of the fidelity table stay within their bounds."""

from __future__ import annotations

from typing import Any

import pytest

QUICK = ["cantilever_small", "torsion", "buckling", "wall_beam", "wall_ring", "straight_advance", "bend_loss", "energy"]
SLOW = [
    "indentation_paper",
    "indentation_in_situ",
    "cantilever_large",
    "volume_stiff",
    "volume_soft",
    "bend_force",
    "bend_tip",
    "sigmoid_force",
    "sigmoid_tip",
    "wall_motion_stiff",
    "wall_motion_soft",
    "action_reaction",
    "base_force",
    "capstan",
    "tunnelling",
    "speed_capsule",
    "speed_magnetic",
    "speed_proximal",
    "random_capsule",
    "parked_drift",
]


def row(fidelity: Any, run: Any, name: str) -> Any:
    (check,) = fidelity.choose(name, quick=False)
    return next(row for row in check.measure(run) if row.name == name)


@pytest.mark.parametrize("name", QUICK)
def test_quick_row_is_within_its_bound(fidelity: Any, run: Any, name: str) -> None:
    measured = row(fidelity, run, name)
    assert measured.ok, fidelity.describe(measured)


@pytest.mark.slow
@pytest.mark.parametrize("name", SLOW)
def test_row_is_within_its_bound(fidelity: Any, run: Any, name: str) -> None:
    measured = row(fidelity, run, name)
    assert measured.ok, fidelity.describe(measured)
