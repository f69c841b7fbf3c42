# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measures of a loop on curves whose turning and crossings are known."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from arcgym.benchmarks.looping import maneuver
from arcgym.benchmarks.looping.shape import measure_loop


def curve(turn: float, rise: float) -> np.ndarray:
    """A coil of radius 50 mm about Y, seen as a circle from the front, between straight ends along +Z."""
    angle = np.linspace(0.0, turn, 60)
    coil = np.stack([0.05 - 0.05 * np.cos(angle), rise * angle / turn, 0.05 * np.sin(angle)], axis=1)
    tangent = np.array([np.sin(turn), 0.0, np.cos(turn)])
    straight = np.linspace(0.01, 0.15, 15)[:, None]
    return np.concatenate([coil[:1] - straight[::-1] * [0.0, 0.0, 1.0], coil, coil[-1:] + straight * tangent])


def test_a_straight_shaft_has_no_loop() -> None:
    loop = measure_loop(np.linspace([0.0, 0.0, 0.0], [0.0, 0.1, 0.5], 30))
    assert (loop.turning, loop.crossings) == (pytest.approx(0.0, abs=1e-3), 0) and not loop.alpha
    assert loop.writhe == pytest.approx(0.0, abs=1e-9)


def test_a_half_turn_is_no_alpha_loop() -> None:
    loop = measure_loop(curve(np.pi, 0.02))
    assert loop.turning == pytest.approx(180.0, abs=15.0) and not loop.alpha


def test_a_full_turn_that_crosses_itself_is_one() -> None:
    loop = measure_loop(curve(2.0 * np.pi - 0.4, 0.04))
    assert loop.turning == pytest.approx(337.0, abs=25.0)
    assert loop.crossings == 1 and loop.alpha
    assert 0.3 < abs(loop.writhe) < 1.0


def test_writhe_changes_its_sign_with_the_mirror_image() -> None:
    points = curve(2.0 * np.pi - 0.4, 0.04)
    mirrored = points * [-1.0, 1.0, 1.0]
    assert measure_loop(mirrored).writhe == pytest.approx(-measure_loop(points).writhe)


@pytest.mark.parametrize("rate", [240, 480])
def test_a_control_step_takes_a_tenth_of_a_second(rate: int, monkeypatch: pytest.MonkeyPatch) -> None:
    taken: list[int] = []
    sim = SimpleNamespace(step=taken.append, physics_dt=1.0 / rate, non_finite=[False])
    monkeypatch.setattr(maneuver, "read", lambda scene, time: {"time": time})
    assert maneuver.advance(SimpleNamespace(sim=sim), "push", 0) == {"time": 0.1}  # type: ignore[arg-type]
    assert taken == [rate // 10]
