# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Gas in the tiny tube: radius 20 mm, 200 mm long, 17 rings of 12 vertices."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
from tiny import TINY_SEGMENTS
from tiny_sim import TinySim, steps

from arcgym.assets import GasCfg
from arcgym.sim import Simulation, SnapshotSet
from arcgym.sim.model_building import wall_lumen
from arcgym.sim.snapshot import fingerprint
from arcgym.sim.wall.lumen_gas import lids, slices, ties

FREE = dict.fromkeys(TINY_SEGMENTS, 0.0)
IMAGED = 20.0 * 133.322
AMBIENT = 101325.0
MIDDLE = 8


@pytest.fixture(scope="module")
def tube(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("gas"), sectors=12)


def filled(tube: TinySim, num_envs: int = 1, colon: dict[str, Any] | None = None, **gas: Any) -> Simulation:
    """Make worlds with gas and a soft wall that is held at its ends alone."""
    cfg = {"material": "in_situ", "anchor_stiffness": FREE, "gas": GasCfg(enabled=True, **gas), **(colon or {})}
    return tube(links=3, num_envs=num_envs, colon=cfg)


def flow_for(sim: Simulation, litres_per_minute: float, seconds: float) -> None:
    sim.colon.set_gas_flow(torch.full((sim.num_envs,), litres_per_minute / 60000.0))
    sim.step(steps(sim, seconds))


def radii(sim: Simulation, ring: int) -> torch.Tensor:
    return sim.colon.data.nodal_pos_w[0, torch.tensor(sim.colon.wall.ring) == ring, :2].norm(dim=1)


def test_the_imaged_shape_is_at_rest_at_the_imaging_pressure(tube: TinySim) -> None:
    sim = filled(tube)
    sim.step(48)
    data = sim.colon.data
    assert data.lumen_pressure.item() == pytest.approx(IMAGED, abs=0.5)
    assert data.nodal_displacement.max() < 1.0e-6
    area = 12 / 2 * np.sin(2 * np.pi / 12) * (0.02 + 0.5 * sim.colon.thickness) ** 2  # of a regular 12-gon
    assert data.lumen_volume.item() == pytest.approx(0.2 * area, rel=0.01)


def test_without_gas_nothing_of_it_is_there(tube: TinySim) -> None:
    sim = tube(links=3)
    assert sim.gas is None and not any("gas" in name for name in {**sim.world_arrays(), **sim.world_settings()})
    with pytest.raises(ValueError, match=r"set env\.scene\.colon\.gas\.enabled=true"):
        _ = sim.colon.data.lumen_pressure


def test_pressure_times_volume_is_what_was_blown_in(tube: TinySim) -> None:
    sim = filled(tube, leak_conductance=0.0)
    before = (AMBIENT + IMAGED) * sim.colon.data.lumen_volume.item()
    flow_for(sim, 0.6, 0.5)  # 0.01 l/s for half a second
    flow_for(sim, 0.0, 0.5)
    data = sim.colon.data
    after = (AMBIENT + data.lumen_pressure.item()) * data.lumen_volume.item()
    assert after - before == pytest.approx(AMBIENT * 5.0e-6, rel=0.01)
    assert data.lumen_pressure.item() > IMAGED + 100.0


def test_a_tube_widens_as_thin_walls_do(tube: TinySim) -> None:
    sim = filled(tube, leak_conductance=0.0)
    at_rest = radii(sim, MIDDLE).mean().item()
    flow_for(sim, 0.6, 0.5)
    flow_for(sim, 0.0, 1.0)
    pressure = sim.colon.data.lumen_pressure.item() - IMAGED
    modulus, ratio = sim.colon.elasticity()
    # Plane strain, since the ends are held: dr = p r^2 (1 - nu^2) / (E t).
    expected = pressure * at_rest**2 * (1.0 - ratio**2) / (modulus * sim.colon.thickness)
    assert radii(sim, MIDDLE).mean().item() - at_rest == pytest.approx(expected, rel=0.1)


def test_a_tube_narrows_alike_below_the_imaging_pressure(tube: TinySim) -> None:
    sim = filled(tube)
    at_rest = radii(sim, MIDDLE).mean().item()
    flow_for(sim, -0.6, 0.25)
    flow_for(sim, 0.0, 1.0)
    pressure = sim.colon.data.lumen_pressure.item() - IMAGED
    assert -IMAGED + sim.colon.cfg.gas.abdominal_pressure < pressure < -100.0  # the gas still holds the wall
    modulus, ratio = sim.colon.elasticity()
    expected = pressure * at_rest**2 * (1.0 - ratio**2) / (modulus * sim.colon.thickness)
    assert radii(sim, MIDDLE).mean().item() - at_rest == pytest.approx(expected, rel=0.1)
    assert radii(sim, MIDDLE).std() < 1.0e-5  # and stays round


@pytest.mark.parametrize("material", ["in_situ", "paper"])
def test_a_jump_of_the_amount_is_followed_without_swinging(tube: TinySim, material: str) -> None:
    sim = filled(tube, colon={"material": material}, leak_conductance=0.0)
    sim.step(1)
    sim.world_arrays()["gas.amount"].mul_(1.01)  # 1040 Pa in a rigid tube
    seen = []
    for _ in range(steps(sim, 0.625)):
        sim.step(1)
        seen.append(sim.colon.data.lumen_pressure.item())
    last, way = seen[-1], seen[-1] - IMAGED
    assert way > 50.0 and max(seen) < last + 0.2 * way and min(seen) > IMAGED - 1.0
    assert max(abs(value - last) for value in seen[steps(sim, 0.017) :]) < 0.01 * way


def test_suction_collapses_the_lumen_and_insufflation_opens_it(tube: TinySim) -> None:
    sim = filled(tube)
    at_rest = sim.colon.data.lumen_volume.item()
    sim.colon.data.nodal_pos_w[0, :, 0] *= 0.99  # a perfect cylinder does not know where to
    flow_for(sim, -6.0, 2.0)
    shut = sim.colon.data.lumen_volume.item()
    assert shut < 0.5 * at_rest and radii(sim, MIDDLE).min() < 0.5 * radii(sim, MIDDLE).max()
    across = sim.colon.data.lumen_pressure.item() - sim.colon.cfg.gas.abdominal_pressure
    assert -1.05 * sim.colon.cfg.gas.suction_depth < across < 0.0
    flow_for(sim, 6.0, 2.0)
    flow_for(sim, 0.0, 2.0)
    assert sim.colon.data.lumen_volume.item() > 0.97 * at_rest
    assert not sim.non_finite.any()


def test_a_soft_tube_that_folds_does_not_swing(tube: TinySim) -> None:
    # Without tension at rest: at 100 Pa below, stiffness is nearly lost, and a pressure that lags would swing.
    sim = filled(tube, leak_conductance=0.0, imaging_pressure=IMAGED, abdominal_pressure=IMAGED)
    sim.colon.data.nodal_pos_w[0, :, 0] *= 0.99
    flow_for(sim, -0.12, 5.0)  # 10 ml
    flow_for(sim, 0.0, 0.5)
    assert radii(sim, MIDDLE).min() < 0.9 * radii(sim, MIDDLE).max()
    assert sim.colon.data.nodal_vel_w.abs().max() < 2.0e-3


def test_gas_beyond_its_opening_pressure_leaks(tube: TinySim) -> None:
    sim = filled(tube, colon={"rigid": True}, start_pressure=IMAGED + 1000.0)
    before = sim.world_arrays()["gas.amount"].item()
    sim.step(steps(sim, 0.05))
    lost = 5.1e-9 * 1000.0 * 0.05 * (AMBIENT + IMAGED + 1000.0)  # conductance, pressure, time
    assert before - sim.world_arrays()["gas.amount"].item() == pytest.approx(lost, rel=0.1)


def test_worlds_are_apart_and_a_state_goes_on_to_the_last_bit(tube: TinySim) -> None:
    sim = filled(tube, num_envs=2)
    flow = torch.tensor([1.0e-5, -1.0e-5])
    sim.colon.set_gas_flow(flow)
    sim.step(48)
    pressure = sim.colon.data.lumen_pressure
    assert pressure[0] > IMAGED + 50.0 and pressure[1] < IMAGED - 50.0
    kept = {name: array.clone() for name, array in sim.world_arrays().items()}
    ends = []
    for _ in range(2):
        sim.write_state(kept)
        sim.forward()
        assert sim.gas is not None and not sim.gas.state.flow.numpy().any()
        sim.colon.set_gas_flow(flow)
        sim.step(24)
        ends.append({name: array.clone() for name, array in sim.world_arrays().items()})
    for name, array in ends[0].items():
        torch.testing.assert_close(ends[1][name], array, rtol=0.0, atol=0.0)


def test_states_without_gas_are_filled_at_the_start_pressure(tube: TinySim) -> None:
    plain = tube(links=3, colon={"material": "in_situ", "anchor_stiffness": FREE})
    states = SnapshotSet(("rest",), (plain.read_snapshot(0),), fingerprint(plain))
    sim = filled(tube, num_envs=2)
    flow_for(sim, -1.0, 0.2)
    sim.load_snapshots(states)
    sim.colon.write_gas_to_sim(start_pressure=torch.tensor([1000.0]), env_ids=[1])
    sim.write_snapshot(0, [1])
    sim.forward()
    pressure, volume = sim.colon.data.lumen_pressure, sim.colon.data.lumen_volume
    assert pressure[1] == 1000.0 and IMAGED - 1500.0 < pressure[0] < IMAGED
    amount = sim.world_arrays()["gas.amount"][1].item()
    assert amount == pytest.approx((AMBIENT + 1000.0) * volume[1].item(), rel=1.0e-5)


def test_a_reset_leaves_the_other_worlds_readings_alone(tube: TinySim) -> None:
    sim = filled(tube, num_envs=2)
    flow_for(sim, 1.0, 0.1)
    names = ("lumen_pressure", "lumen_pressure_mean", "lumen_pressure_peak", "lumen_volume")
    before = [getattr(sim.colon.data, name)[0].item() for name in names]
    sim.write_snapshot(-1, [1])
    sim.forward(torch.tensor([False, True]))
    assert [getattr(sim.colon.data, name)[0].item() for name in names] == before
    assert sim.colon.data.lumen_pressure[1].item() == pytest.approx(IMAGED)


def test_a_rigid_wall_has_gas_too(tube: TinySim) -> None:
    sim = filled(tube, colon={"rigid": True}, leak_conductance=0.0)
    volume = sim.colon.data.lumen_volume.item()
    flow_for(sim, 0.06, 0.5)  # 0.5 ml
    risen = sim.colon.data.lumen_pressure.item() - IMAGED
    assert risen == pytest.approx(AMBIENT * 0.5e-6 / volume, rel=0.01)


def test_what_gas_needs_is_said(tube: TinySim) -> None:
    with pytest.raises(ValueError, match=r"wall_model is 'solid', expected 'shell' with gas\.enabled=true"):
        tube.colon_cfg(wall_model="solid", gas=GasCfg(enabled=True)).validate_config()
    with pytest.raises(ValueError, match=r"has no gas in the lumen: set env\.scene\.colon\.gas\.enabled=false"):
        tube(links=3, colon={"gas": GasCfg(enabled=True)}, solver="newton")
    with pytest.raises(ValueError, match="imaging_pressure is 100 Pa, expected at least the abdominal pressure"):
        GasCfg(imaging_pressure=100.0).validate_config()


def test_lids_close_a_square_pipe() -> None:
    # Four vertices at the bottom, four at the top, eight faces between them, normals outwards.
    faces = np.array([[k, (k + 1) % 4, 4 + (k + 1) % 4] for k in range(4)])
    faces = np.concatenate([faces, [[k, 4 + (k + 1) % 4, 4 + k] for k in range(4)]])
    closed = np.concatenate([faces, lids(faces)])
    x = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    x = np.concatenate([x, x + [0.0, 0.0, 3.0]]) + [5.0, 6.0, 7.0]
    corners = x[closed]
    assert len(closed) == 12
    assert np.linalg.det(corners).sum() / 6.0 == pytest.approx(2.0 * 2.0 * 3.0)


def test_ties_bear_the_pressure_in_a_cylinder(tube: TinySim) -> None:
    sim = filled(tube)
    wall, x = sim.colon.wall, sim.colon.wall.points.astype(float)
    corners = wall.triangles
    radius = slices(x, wall_lumen(wall)).radius
    assert radius[MIDDLE] == pytest.approx(0.02 + 0.5 * sim.colon.thickness, rel=0.04)
    pull = ties(x, corners, wall.ring, radius).reshape(-1, 3, 2)
    force = np.zeros_like(x)
    for k in range(3):
        here = corners[:, k]
        for side, other in enumerate((corners[:, (k + 1) % 3], corners[:, (k + 2) % 3])):
            np.add.at(force, here, pull[:, k, side, None] * (x[other] - x[here]))
    normal = np.cross(x[corners[:, 1]] - x[corners[:, 0]], x[corners[:, 2]] - x[corners[:, 0]]) / 6.0
    load = np.zeros_like(x)
    for k in range(3):
        np.add.at(load, corners[:, k], normal)
    inner = wall.ring == MIDDLE
    np.testing.assert_allclose(force[inner], -load[inner], atol=0.05 * np.abs(load[inner]).max())
