# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Graded shafts, and wheels with play and lag, on a scope of six links: three of 25 mm, three of 10 mm that bend."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from tiny_sim import TinySim, steps

from arcgym.assets import GradingCfg
from arcgym.sim import Simulation, SnapshotSet
from arcgym.sim.snapshot import fingerprint


def stiffness(sim: Simulation) -> np.ndarray:
    return np.asarray(sim.model.joint_target_ke.numpy())


def wheel(sim: Simulation, pitch: float, seconds: float) -> float:
    """Turn the first wheel towards an angle for a while; return the bending that the section is driven to."""
    zero = torch.zeros(sim.num_envs)
    sim.endoscope.set_bending_command(zero + pitch, zero)
    sim.step(steps(sim, seconds))
    return float(sim.endoscope.actuator("bending").angle.numpy()[0, 0])


def test_a_graded_shaft_is_softer_near_the_tip(tiny_sim: TinySim) -> None:
    plain, graded = tiny_sim(), tiny_sim(scope={"grading": GradingCfg(passive_length=0.03, distal_length=0.06)})
    ratio = stiffness(graded) / stiffness(plain)
    # Slide, roll, then pitch and yaw of each hinge; the fourth also twists. Hinge 1 is 50 mm behind the bending
    # section, hinge 2 is 25 mm, hinge 3 is at its beginning.
    assert ratio[2:6] == pytest.approx([0.8, 0.8, 0.4, 0.4])
    assert np.delete(ratio, [2, 3, 4, 5]) == pytest.approx(1.0)


def test_the_shaft_is_even_by_default(tiny_sim: TinySim) -> None:
    assert not GradingCfg().active and GradingCfg().share(0.0) == 1.0
    drive = tiny_sim().endoscope.actuator("bending")
    assert set(drive.memory) == {"angle"}


def test_the_section_follows_when_the_play_is_used_up(tiny_sim: TinySim) -> None:
    sim = tiny_sim(scope={"drives": {"bending": {"play": 0.1}}})
    assert wheel(sim, 0.3, 0.5) == pytest.approx(0.3 - 0.1, abs=1.0e-6)
    assert wheel(sim, 0.15, 0.5) == pytest.approx(0.2, abs=1.0e-6)  # turned back by less than twice the play
    assert wheel(sim, 0.0, 0.5) == pytest.approx(0.0 + 0.1, abs=1.0e-6)
    assert wheel(sim, -0.3, 0.5) == pytest.approx(-0.3 + 0.1, abs=1.0e-6)


def test_the_section_lags(tiny_sim: TinySim) -> None:
    sim = tiny_sim(scope={"drives": {"bending": {"lag": 0.2, "rate": 1000.0}}})
    assert wheel(sim, 0.2, 0.2) == pytest.approx(0.2 * (1.0 - math.exp(-1.0)), rel=1.0e-3)


def test_a_state_keeps_where_the_wheels_are(tiny_sim: TinySim) -> None:
    sim = tiny_sim(scope={"drives": {"bending": {"play": 0.1, "lag": 0.1}}})
    wheel(sim, 0.3, 0.2)
    kept = {name: array.clone() for name, array in sim.world_arrays().items()}
    ends = []
    for _ in range(2):
        sim.write_state(kept)
        sim.forward()
        ends.append(wheel(sim, -0.2, 0.1))
    assert ends[0] == ends[1]


def test_a_state_without_play_fits_and_begins_in_the_middle(tiny_sim: TinySim) -> None:
    plain = tiny_sim()
    wheel(plain, 0.2, 0.5)
    sim = tiny_sim(scope={"drives": {"bending": {"play": 0.1}}})
    wheel(sim, 0.3, 0.5)
    sim.load_snapshots(SnapshotSet(("bent",), (plain.read_snapshot(0),), fingerprint(plain)))
    sim.write_snapshot(0)
    sim.forward()
    sim.step(steps(sim, 0.1))  # the wheels stay
    assert sim.endoscope.actuator("bending").angle.numpy()[0, 0] == pytest.approx(0.2, abs=1.0e-6)
    assert wheel(sim, 0.25, 0.5) == pytest.approx(0.2, abs=1.0e-6)
    assert wheel(sim, 0.35, 0.5) == pytest.approx(0.25, abs=1.0e-6)
