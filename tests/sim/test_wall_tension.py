# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tension of an inflated wall at rest, in tiny tubes of radius 20 mm, 200 mm long."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
import warp as wp
from static_force import static_force
from tiny import TINY_SEGMENTS
from tiny_sim import TinySim

from arcgym.assets import ColonCfg, GasCfg, WallLawCfg
from arcgym.sim import Simulation
from arcgym.start_states.key import settings_of

FREE = dict.fromkeys(TINY_SEGMENTS, 0.0)
ACROSS = 13.5 * 133.322
"""Pressure across the wall when it was imaged [Pa]."""
PLAIN = {"material": "in_situ"}
TISSUE = {"material": "clinical", "wall_law": WallLawCfg(stiffening=1.5)}


@pytest.fixture(scope="module")
def tube(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("straight"), rings=41, sectors=24, capped=False)


@pytest.fixture(scope="module")
def bent(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("bent"), bend=1.5, sectors=12)


def filled(tube: TinySim, colon: dict[str, Any], **gas: Any) -> Simulation:
    cfg = {"anchor_stiffness": FREE, "gas": GasCfg(enabled=True, **gas), **colon}
    return tube(links=3, colon=cfg)


def forces(sim: Simulation, x: np.ndarray) -> np.ndarray:
    """Return the force on each vertex at rest at ``x`` [N], both of shape (V, 3)."""
    at = wp.array(x[:, None].astype(np.float32), dtype=wp.vec3, device=sim.device)
    return static_force(sim, at).numpy()[:, 0].astype(float)


def around(sim: Simulation) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return angle and directions outwards and around of each vertex, shape (V,) and (V, 3) each."""
    points = sim.colon.wall.points.astype(float)
    angle = np.arctan2(points[:, 1], points[:, 0])
    nothing = 0.0 * angle
    return (
        angle,
        np.column_stack([np.cos(angle), np.sin(angle), nothing]),
        np.column_stack([-np.sin(angle), np.cos(angle), nothing]),
    )


@pytest.mark.parametrize("colon", [PLAIN, TISSUE], ids=["plain", "tissue"])
def test_a_bent_tube_is_at_rest_in_its_image(bent: TinySim, colon: dict[str, Any]) -> None:
    sim = filled(bent, colon, pretension=True)
    sim.step(48)
    assert sim.colon.data.nodal_displacement.max() < 1.0e-6
    pressure, area = ACROSS, 0.2 * 2.0 * np.pi * 0.02 / len(sim.colon.wall.points)
    held = sim.wall.gas.loads.hold.numpy()[:, 0]  # a bend of radius 133 mm leaves over some of what a tube balances
    assert 0.01 < np.linalg.norm(held, axis=1).max() / (pressure * area)


def test_a_colon_that_is_turned_as_a_whole_feels_nothing(bent: TinySim) -> None:
    sim = filled(bent, TISSUE, pretension=True)
    points = sim.colon.wall.points.astype(float)
    turn = np.array([[0.36, -0.8, 0.48], [0.48, 0.6, 0.64], [-0.8, 0.0, 0.6]])  # orthonormal
    turn[:, 0] *= np.sign(np.linalg.det(turn))
    push = ACROSS * 0.2 * 2.0 * np.pi * 0.02 / len(points)  # of the gas on a vertex, 0.15 N
    inside = (sim.colon.wall.ring > 0) & sim.colon.mobile()
    assert np.abs(forces(sim, points)[inside]).max() < 1.0e-4 * push
    assert np.abs(forces(sim, points @ turn.T)[inside]).max() < 1.0e-4 * push


@pytest.mark.parametrize("colon", [PLAIN, TISSUE], ids=["plain", "tissue"])
def test_a_tube_pressed_oval_resists_by_its_tension(tube: TinySim, colon: dict[str, Any]) -> None:
    """Outwards by a cos 2t, around by -a/2 sin 2t, a ring keeps its length: p (n^2 - 1) / R resists, n = 2.

    A pressure p and the tension p R that bears it are worth p (n^2 - 1) for each radian of an inextensible ring.
    """
    stiffness = []
    for pretension in (False, True):
        sim = filled(tube, colon, pretension=pretension)
        angle, outwards, sideways = around(sim)
        points = sim.colon.wall.points.astype(float)
        radius = np.hypot(points[:, 0], points[:, 1]).mean()
        mode = np.cos(2.0 * angle)[:, None] * outwards - 0.5 * np.sin(2.0 * angle)[:, None] * sideways
        size = 1.0e-4
        pull = 0.5 * (forces(sim, points - size * mode) - forces(sim, points + size * mode)) / size
        middle = np.abs(sim.colon.wall.ring - 20) < 6
        work = (pull * mode)[middle].sum()  # pi (n^2 - 1) p a^2 for each meter, 11 rings of 5 mm
        stiffness.append(work / (11 * 0.005) / (np.pi * 3.0))
    assert stiffness[1] - stiffness[0] == pytest.approx(ACROSS, rel=0.05)
    bending = stiffness[0]
    assert bending < (0.25 if colon is TISSUE else 1.0) * ACROSS and radius > 0.02


@pytest.mark.parametrize("colon", [PLAIN, TISSUE], ids=["plain", "tissue"])
def test_a_wave_along_a_tube_meets_its_lengthwise_tension(tube: TinySim, colon: dict[str, Any]) -> None:
    """Outwards by sin kz, alike all around, the tension p R / 2 along resists with p R k^2 / 2 on each area.

    Nothing else of tension and pressure does: the wider ring's tension bears its pressure still. Bent as a beam,
    sideways by sin kz and along by -x k cos kz, tension and the gas's thrust on the bends cancel but for the tension
    along, on what the wall is stretched: p R / 2 times (x k^2 sin kz)^2 on each area.
    """
    work = {}
    for pretension in (False, True):
        sim = filled(tube, colon, pretension=pretension)
        outwards = around(sim)[1]
        points = sim.colon.wall.points.astype(float)
        k = 2.0 * np.pi / 0.1
        wave = np.sin(k * points[:, 2])[:, None]
        middle = (sim.colon.wall.ring >= 10) & (sim.colon.wall.ring < 30)  # a wave of 20 rings
        bend = wave * np.array([1.0, 0.0, 0.0])
        bend[:, 2] = -points[:, 0] * k * np.cos(k * points[:, 2])
        for name, mode in {"outwards": wave * outwards, "bent": bend}.items():
            size = 1.0e-4
            pull = 0.5 * (forces(sim, points - size * mode) - forces(sim, points + size * mode)) / size
            work[name, pretension] = (pull * mode)[middle].sum()
    radius = np.hypot(points[:, 0], points[:, 1]).mean()
    tension = 0.5 * ACROSS * radius * k**2 * 0.5 * 0.1 * 2.0 * np.pi * radius  # the mean of sin^2 is a half
    assert work["outwards", True] - work["outwards", False] == pytest.approx(tension, rel=0.08)
    left = 0.5 * (radius * k) ** 2 * tension  # the mean of x^2 is half of R^2
    assert work["bent", True] - work["bent", False] == pytest.approx(left, abs=0.08 * tension)


def test_an_empty_lumen_is_as_without(bent: TinySim) -> None:
    """Where no gas bears the wall, the whole of its tension draws, as it does without the switch."""
    found = []
    for pretension in (False, True):
        sim = filled(bent, PLAIN, pretension=pretension)
        gas = sim.wall.gas
        sim.colon.write_gas_to_sim(start_pressure=torch.tensor([6.5 * 133.322 - 50.0]))  # 50 Pa below the abdomen's
        gas.state.amount.zero_()
        gas.fill(sim.nodal_pos, wp.ones(1, dtype=wp.bool, device=sim.device))
        found.append(forces(sim, sim.colon.wall.points.astype(float)))
    assert np.abs(found[0]).max() > 0.01
    np.testing.assert_allclose(found[1], found[0], atol=1.0e-6)


def test_a_state_goes_on_to_the_last_bit(bent: TinySim) -> None:
    sim = filled(bent, TISSUE, pretension=True)
    sim.colon.set_gas_flow(torch.tensor([-2.0e-5]))
    sim.step(24)
    kept = {name: array.clone() for name, array in sim.world_arrays().items()}
    ends = []
    for _ in range(2):
        sim.write_state(kept)
        sim.forward()
        sim.step(24)
        ends.append({name: array.clone() for name, array in sim.world_arrays().items()})
    for name, array in ends[0].items():
        torch.testing.assert_close(ends[1][name], array, rtol=0.0, atol=0.0)


def test_start_states_know_of_a_tension_alone() -> None:
    plain, gassy = ColonCfg(), ColonCfg(gas=GasCfg(enabled=True))
    tense = ColonCfg(gas=GasCfg(enabled=True, pretension=True))
    assert settings_of(plain) == settings_of(gassy) == settings_of(ColonCfg(gas=GasCfg(pretension=True)))
    assert settings_of(tense)["tension"] == pytest.approx(ACROSS)
