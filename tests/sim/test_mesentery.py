# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Sheets on which the second fifth of the tiny tube hangs, 0.2 m along Z with rings 12.5 mm apart."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
from tiny_sim import TinySim

from arcgym.assets import MesenteryCfg
from arcgym.sim import Simulation
from arcgym.utils.configclass import validate

HEIGHT = 0.05
RING = 5
STEP = 1.0 / 480.0


@pytest.fixture(scope="module")
def tube(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("mesentery"))


def hanging(tube: TinySim, num_envs: int = 1, **mesentery: Any) -> Simulation:
    """Make worlds whose sigmoid hangs on a sheet."""
    cfg = MesenteryCfg(**{"enabled": True, "height": {"sigmoid": HEIGHT}, **mesentery})
    return tube("magnetic", num_envs=num_envs, colon={"mesentery": cfg, "material": "in_situ"})


def pull(sim: Simulation, way: tuple[float, float, float], world: int = 0) -> np.ndarray:
    """Return the force on a ring that is moved by ``way`` [m] from rest [N], shape (3,)."""
    x = sim.nodal_pos.numpy()
    own = sim.colon.wall.ring == RING
    x[own] = sim.colon.wall.points[own][:, None] + np.array(way, np.float32)
    sim.nodal_pos.assign(x)
    sim.surroundings.measure(sim.nodal_pos, sim.wall.tissue, STEP)
    force = sim.surroundings.force
    push, stiffness = (array.numpy()[own, world] for array in (force.push, force.stiffness))
    return (push - np.einsum("vij,vj->vi", stiffness, x[own, world])).sum(axis=0)


def height(sim: Simulation) -> float:
    return float(sim.surroundings.mesentery.sheets.height.numpy()[RING, 0])


def test_without_sheets_springs_with_slack_hold_it(tube: TinySim) -> None:
    sim = tube(colon={"material": "in_situ"})
    assert sim.surroundings is None and sim.colon.anchor_springs().slack.max() > 0.05
    with pytest.raises(ValueError, match=r"set env\.scene\.colon\.mesentery\.enabled=true"):
        sim.colon.write_mesentery_to_sim(torch.ones(1))


def test_sheets_take_the_place_of_the_springs(tube: TinySim) -> None:
    sim = hanging(tube)
    springs, sigmoid = sim.colon.anchor_springs(), sim.colon.wall.segment == 1
    assert springs.slack[sigmoid].max() == 0.0
    # What is left of 30 N/m^2 on 12.5 mm of eight vertices each.
    np.testing.assert_allclose(springs.stiffness[sigmoid], 30.0 * 0.0125 / 8)
    held = sim.surroundings.mesentery.sheets.height.numpy()[:, 0] > 0.0
    assert set(np.flatnonzero(held)) == set(sim.colon.wall.ring[sigmoid])


def test_a_height_falls_to_the_least_at_both_ends(tube: TinySim) -> None:
    heights = hanging(tube, least_height=0.01).surroundings.mesentery.sheets.height.numpy()[:, 0]
    own = heights[heights > 0.0]
    # Rings 4 to 6 of the second fifth: a sine at 0, 1/2 and 1.
    np.testing.assert_allclose(own, [0.01, HEIGHT, 0.01], rtol=1.0e-5)


def test_it_swings_freely_about_the_root_and_no_farther(tube: TinySim) -> None:
    sim = hanging(tube)
    h = height(sim)
    for angle in (-1.0, 0.5, 2.0):  # about an axis along Z through the root, h behind the ring
        assert abs(pull(sim, (0.998 * h * np.sin(angle), h * (0.998 * np.cos(angle) - 1.0), 0.0))).max() == 0.0
    for way in ((0.0, -0.9 * h, 0.0), (0.0, -1.5 * h, 0.0)):  # to the root and past it: folds
        assert abs(pull(sim, way)).max() == 0.0
    # 10 and 30 % farther: 140 N/m / 8 (e^0.8 - 1) = 21.4 N/m and 175 N/m, of 12.5 mm.
    for strain, tension in ((0.1, 21.45), (0.3, 175.4)):
        np.testing.assert_allclose(
            pull(sim, (0.0, strain * h, 0.0)), [0.0, -tension * 0.0125, 0.0], rtol=5.0e-3, atol=1e-5
        )
        aside = pull(sim, ((1.0 + strain) * h, -h, 0.0))
        np.testing.assert_allclose(aside, [-tension * 0.0125, 0.0, 0.0], rtol=5.0e-3, atol=2.0e-5)


def test_beyond_the_largest_strain_it_is_a_spring(tube: TinySim) -> None:
    sim = hanging(tube, largest_strain=0.2, stiffening=0.0)
    for strain in (0.1, 0.3):
        assert -pull(sim, (0.0, strain * height(sim), 0.0))[1] == pytest.approx(140.0 * strain * 0.0125, rel=1.0e-3)


def test_worlds_have_sheets_of_their_own(tube: TinySim) -> None:
    sim = hanging(tube, num_envs=3)
    sim.colon.write_mesentery_to_sim(fullness=torch.tensor([1.5]), env_ids=[1])
    sim.colon.write_mesentery_to_sim(stiffness=torch.tensor([280.0]), env_ids=[2])
    pulls = [pull(sim, (0.0, 0.2 * height(sim), 0.0), world)[1] for world in range(3)]
    assert pulls[1] == 0.0 and pulls[2] == pytest.approx(2.0 * pulls[0], rel=1.0e-4) and pulls[0] < 0.0
    assert sim.world_settings()["mesentery.fullness"].tolist() == pytest.approx([1.0, 1.5, 1.0])
    stretch = sim.colon.data.mesentery_stretch
    sim.forward()
    stretch = sim.colon.data.mesentery_stretch[:, RING]
    torch.testing.assert_close(stretch, torch.tensor([0.2, 0.0, 0.2]) * height(sim), rtol=1.0e-3, atol=1.0e-5)


def test_it_rests_as_imaged_and_its_tension_is_read(tube: TinySim) -> None:
    sim = hanging(tube)
    sim.step(12)
    assert sim.colon.data.nodal_displacement.max() < 1.0e-6
    pull(sim, (0.0, 0.3 * height(sim), 0.0))
    sim.wall_readout.clear()
    sim.wall_readout.measure(sim.nodal_pos)
    sim.surroundings.read(sim.nodal_pos, sim.wall.tissue, sim.wall_readout)
    tension = sim.colon.data.anchor_tension_peak[0, RING].item()
    # The sheet's, and 30 N/m^2 of hanging spring.
    assert tension == pytest.approx(0.0125 * (175.4 + 30.0 * 0.3 * height(sim)), rel=5.0e-3)


def test_what_it_needs_is_said(tube: TinySim) -> None:
    with pytest.raises(ValueError, match=r"has no mesenteries: set env\.scene\.colon\.mesentery\.enabled=false"):
        tube(solver="newton", colon={"mesentery": MesenteryCfg(enabled=True)})
    with pytest.raises(ValueError, match=r"height names 'sigmoyd'\. Did you mean 'sigmoid'"):
        validate(MesenteryCfg(height={"sigmoyd": 0.1}))
    with pytest.raises(ValueError, match="expected a direction"):
        validate(MesenteryCfg(root=(0.0, 0.0, 0.0)))
