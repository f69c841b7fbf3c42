# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Stiffening, thickness and relaxation of the tiny tube's wall: radius 20 mm, 200 mm long, 17 rings of 12 vertices."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import torch
from tiny import TINY_SEGMENTS
from tiny_sim import TinySim, steps

from arcgym.assets import GasCfg, WallLawCfg
from arcgym.sim import Simulation, SnapshotSet
from arcgym.sim.snapshot import fingerprint
from arcgym.sim.wall.thickness import thickness_shares

FREE = dict.fromkeys(TINY_SEGMENTS, 0.0)
IMAGED = 20.0 * 133.322
BAND = 8


@pytest.fixture(scope="module")
def tube(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("law"), sectors=12)


def lawful(tube: TinySim, num_envs: int = 1, colon: dict[str, Any] | None = None, **law: Any) -> Simulation:
    """Make worlds with a wall law and a soft wall that is held at its ends alone."""
    cfg = {"material": "in_situ", "anchor_stiffness": FREE, "wall_law": WallLawCfg(**law), **(colon or {})}
    return tube("capsule", num_envs=num_envs, colon=cfg)


def stretch(sim: Simulation, factor: float) -> None:
    """Stretch the tube along its axis, and hold it so."""
    sim.colon.data.nodal_pos_w[..., 2] *= factor
    sim.colon.write_rigid_to_sim(torch.ones(sim.num_envs, dtype=torch.bool))


def pull(sim: Simulation, world: int = 0) -> float:
    """Return the force along Z between two rings half way [N]."""
    sim.wall.elements.measure(sim.nodal_pos, sim.wall.tissue)
    data: Any = sim.wall.elements.data
    shell = getattr(data, "shell", data)
    ring = sim.colon.wall.ring[shell.triangles.numpy()]
    across = (ring.min(axis=1) == BAND) & (ring.max(axis=1) == BAND + 1)
    force = shell.corner_force.numpy()[:, world, 2].reshape(-1, 3)
    return float(-(force * (ring == BAND + 1))[across].sum())


def uniaxial(sim: Simulation, stretch: float, stiffening: float) -> float:
    """Return the force of the tube when it is stretched and does not narrow [N]."""
    shear, lame, _ = sim.moduli[0].tolist()
    green = stretch**2 - 1.0  # I - 2 of a stretch along one axis
    # The axial component of S = mu (1 + b (I - 2)^2) Id + (lambda ln J - mu) C^-1, times the stretch: first Piola.
    stress = stretch * (shear * (1.0 + stiffening * green**2) + (lame * math.log(stretch) - shear) / stretch**2)
    perimeter = 12 * 2 * math.sin(math.pi / 12) * (0.02 + 0.5 * sim.colon.thickness)
    return stress * perimeter


def test_all_off_is_the_plain_shell(tube: TinySim) -> None:
    sim = lawful(tube)
    assert type(sim.wall.elements).__name__ == "Shell" and not sim.wall.elements.memory
    assert not any("relaxation" in name for name in sim.world_arrays())


@pytest.mark.parametrize("factor", [0.0, 2.75, 20.0])
def test_a_stretched_tube_pulls_as_the_law_says(tube: TinySim, factor: float) -> None:
    sim = lawful(tube, stiffening=factor)
    stretch(sim, 1.3)
    assert pull(sim) == pytest.approx(uniaxial(sim, 1.3, factor), rel=1.0e-3)


def test_the_law_with_the_plain_factor_is_the_plain_one(tube: TinySim) -> None:
    ends = []
    for law in ({}, {"stiffening": 2.75}):
        sim = lawful(tube, **law)
        sim.colon.data.nodal_pos_w[0, :, 0] *= 1.2
        sim.step(24)
        ends.append(sim.colon.data.nodal_pos_w.clone())
    assert (ends[0] - sim.colon.data.default_nodal_pos_w).abs().max() > 1.0e-4
    torch.testing.assert_close(ends[1], ends[0], rtol=0.0, atol=1.0e-6)


def test_wide_rings_are_thin() -> None:
    around = np.exp(2j * np.pi * np.arange(12) / 12)
    rings = [np.stack([r * around.real, r * around.imag, 0 * around.real], axis=1) for r in (0.01, 0.02, 0.04)]
    law = WallLawCfg(thickness_by_diameter=True)
    share = thickness_shares(law, np.concatenate(rings), np.repeat(np.arange(3), 12), 0.0015)
    np.testing.assert_allclose(1.5 * share, [3.0, 1.5, 0.75])  # mm: 60 mm^2 over 20, 40 and 80 mm


def test_a_thicker_wall_weighs_and_bears_more(tmp_path_factory: pytest.TempPathFactory) -> None:
    narrow = TinySim(tmp_path_factory.mktemp("narrow"), sectors=12, radius=0.01)
    plain = lawful(narrow)
    sim = lawful(narrow, thickness_by_diameter=True)
    diameter = 2.0 * (0.01 + 0.5 * sim.colon.thickness)
    share = 60.0e-6 / diameter / sim.colon.thickness
    inner = np.isin(sim.colon.wall.ring, range(2, 14))
    masses = [one.wall.nodes.mass.numpy()[inner, 0].sum() for one in (plain, sim)]
    assert masses[1] / masses[0] == pytest.approx(share, rel=1.0e-4)
    forces = []
    for one in (plain, sim):
        stretch(one, 1.1)
        forces.append(pull(one))
    assert forces[1] / forces[0] == pytest.approx(share, rel=1.0e-3)
    first, second = (getattr(one.wall.elements.data, "shell", one.wall.elements.data) for one in (plain, sim))
    middle = first.coupling.shape[0] // 2
    ratio = second.coupling.numpy()[middle, 0, 0, 0] / first.coupling.numpy()[middle, 0, 0, 0]
    assert ratio == pytest.approx(share**3, rel=1.0e-3)


def test_a_held_stretch_loses_its_pull(tube: TinySim) -> None:
    sim = lawful(tube, relaxation=True, relaxing_share=(0.3, 0.2), relaxing_time=(0.1, 1.0))
    stretch(sim, 1.1)
    first = pull(sim)
    seen = []
    for _ in range(4):
        sim.step(steps(sim, 0.125))
        seen.append(pull(sim) / first)
    series = [1.0 - 0.3 * (1.0 - math.exp(-t / 0.1)) - 0.2 * (1.0 - math.exp(-t)) for t in (0.125, 0.25, 0.375, 0.5)]
    assert seen == pytest.approx(series, rel=1.0e-3)


def test_a_moving_wall_feels_what_has_faded(tube: TinySim) -> None:
    sims = [lawful(tube, relaxation=True, relaxing_time=(0.05, 0.05)), lawful(tube, stiffening=2.75)]
    widths = []
    for sim in sims:
        sim.colon.data.nodal_pos_w[0, sim.colon.wall.ring == BAND, :2] *= 1.3
        sim.colon.write_rigid_to_sim(torch.ones(1, dtype=torch.bool))
        sim.step(steps(sim, 0.5))
        sim.colon.write_rigid_to_sim(torch.zeros(1, dtype=torch.bool))
        before = sim.colon.data.nodal_pos_w[0, sim.colon.wall.ring == BAND, :2].norm(dim=1).mean().item()
        sim.step(3)
        after = sim.colon.data.nodal_pos_w[0, sim.colon.wall.ring == BAND, :2].norm(dim=1).mean().item()
        widths.append(before - after)
    assert 0.1 * widths[1] < widths[0] < 0.9 * widths[1]


def test_a_state_goes_on_to_the_last_bit_and_one_without_memory_has_rested(tube: TinySim) -> None:
    gas = GasCfg(enabled=True, start_pressure=IMAGED + 500.0, leak_conductance=0.0)
    law = WallLawCfg(stiffening=1.5, thickness_by_diameter=True, relaxation=True, relaxing_time=(0.1, 1.0))
    sim = lawful(tube, 2, {"gas": gas, "wall_law": law})
    sim.step(48)
    kept = {name: array.clone() for name, array in sim.world_arrays().items()}
    assert kept["relaxation.quick"].shape == (2, len(sim.colon.wall.triangles), 3)
    assert kept["relaxation.quick"].abs().max() > 0.0
    ends = []
    for _ in range(2):
        sim.write_state(kept)
        sim.forward()
        sim.step(24)
        ends.append({name: array.clone() for name, array in sim.world_arrays().items()})
    for name, array in ends[0].items():
        torch.testing.assert_close(ends[1][name], array, rtol=0.0, atol=0.0)
    plain = tube("capsule", colon={"material": "in_situ", "anchor_stiffness": FREE})
    sim.load_snapshots(SnapshotSet(("rest",), (plain.read_snapshot(0),), fingerprint(plain)))
    sim.write_snapshot(0, [1])
    sim.forward()
    assert sim.world_arrays()["relaxation.quick"][1].abs().max() == 0.0
    assert sim.world_arrays()["relaxation.quick"][0].abs().max() > 0.0


def test_what_the_law_needs_is_said(tube: TinySim) -> None:
    with pytest.raises(ValueError, match=r"wall_model is 'solid', expected 'shell' with any of wall_law"):
        tube.colon_cfg(wall_model="solid", wall_law=WallLawCfg(relaxation=True)).validate_config()
    with pytest.raises(ValueError, match="expected a sum of at most 0.9"):
        WallLawCfg(relaxing_share=(0.5, 0.5)).validate_config()
    with pytest.raises(ValueError, match="has the plain law of the wall"):
        tube("capsule", colon={"wall_law": WallLawCfg(stiffening=1.0)}, solver="newton")
