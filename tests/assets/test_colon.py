# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The colon as an asset: overrides of its material, views on its state, writes by world."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from tiny_sim import TinySim

from arcgym.assets import ColonCfg
from arcgym.assets.colon import Colon
from arcgym.sim import Simulation
from arcgym.sim.model_building import wall_parameters

RINGS, NODES = 17, 17 * 8


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("colon"))


@pytest.fixture
def sim(tiny: TinySim) -> Simulation:
    return tiny("capsule", num_envs=2)


def test_shapes(sim: Simulation) -> None:
    colon = sim.colon
    assert (colon.num_nodes, colon.num_rings) == (NODES, RINGS)
    assert colon.data.nodal_pos_w.shape == colon.data.nodal_vel_w.shape == (2, NODES, 3)
    assert colon.data.nodal_state_w.shape == colon.data.default_nodal_state_w.shape == (2, NODES, 6)
    assert colon.data.nodal_displacement.shape == (2, NODES)
    assert colon.data.centerline_pos_w.shape == (2, RINGS, 3)
    assert colon.data.root_pos_w.shape == (2, 3)


def test_positions_share_memory_with_the_simulation(sim: Simulation) -> None:
    sim.colon.data.nodal_pos_w[1, 3] = torch.tensor([1.0, 2.0, 3.0])
    np.testing.assert_array_equal(sim.colon.nodal_pos_wp.numpy()[3, 1], [1.0, 2.0, 3.0])


def test_rings_start_on_the_axis_at_their_arc_length(sim: Simulation) -> None:
    arc = torch.linspace(0.0, 0.2, RINGS)
    torch.testing.assert_close(sim.colon.data.centerline_arc, arc.expand(2, -1))
    for world in range(2):
        expected = torch.stack([torch.zeros(RINGS), torch.zeros(RINGS), arc], dim=1)
        centers = sim.colon.data.centerline_pos_w[world, :-1]  # the blind end is half a thickness farther out
        torch.testing.assert_close(centers, expected[:-1], atol=1e-6, rtol=0.0)


def test_displacement_is_the_distance_from_rest(sim: Simulation) -> None:
    sim.colon.data.nodal_pos_w[0, 7] += torch.tensor([0.003, 0.0, 0.004])
    assert sim.colon.data.nodal_displacement[0, 7].item() == pytest.approx(0.005, rel=1e-4)
    assert not sim.colon.data.nodal_displacement[1].any()


def test_writes_reach_the_named_worlds_only(sim: Simulation) -> None:
    data, rest = sim.colon.data, sim.colon.data.default_nodal_state_w
    sim.colon.write_nodal_pos_to_sim(rest[1:, :, :3] + 1.0, [1])
    sim.colon.write_nodal_velocity_to_sim(torch.full((1, NODES, 3), 2.0), torch.tensor([0]))
    torch.testing.assert_close(data.nodal_pos_w, rest[..., :3] + torch.tensor([0.0, 1.0]).view(2, 1, 1))
    assert (data.nodal_vel_w[0] == 2.0).all() and not data.nodal_vel_w[1].any()
    sim.colon.write_nodal_state_to_sim(rest)
    assert torch.equal(data.nodal_state_w, rest)


def press(sim: Simulation, depth: float) -> None:
    """Press a capsule against the wall in both worlds."""
    pose = torch.tensor([0.0129 + depth, 0.0015, 0.1, 0.0, 0.0, 0.0, 1.0])
    sim.endoscope.data.joint_pos[:] = pose
    sim.endoscope.data.joint_vel.zero_()
    sim.forward()


def test_stiffness_scale_changes_its_own_world_only(sim: Simulation, tiny: TinySim) -> None:
    plain = tiny("capsule", num_envs=2)
    sim.colon.write_stiffness_scale_to_sim(torch.tensor([0.1]), [1])
    for one in (sim, plain):
        press(one, 0.001)
        one.step(10)
    assert torch.equal(sim.colon.data.nodal_pos_w[0], plain.colon.data.nodal_pos_w[0])
    soft, stiff = sim.colon.data.nodal_displacement.amax(dim=1).flip(0)
    assert soft > 1.5 * stiff


def test_scaling_the_stiffness_equals_a_softer_material(sim: Simulation, tiny: TinySim) -> None:
    soft = tiny("capsule", num_envs=2, colon={"youngs_modulus": 0.5e6})
    sim.colon.write_stiffness_scale_to_sim(torch.full((2,), 0.1))
    for one in (sim, soft):
        press(one, 0.001)
        one.step(10)
    torch.testing.assert_close(sim.colon.data.nodal_pos_w, soft.colon.data.nodal_pos_w, atol=1e-6, rtol=0.0)


def test_overrides_win_over_the_preset_over_the_stage(tiny: TinySim) -> None:
    assert Colon(tiny.colon_cfg(material="paper")).elasticity() == (5.0e6, 0.49)
    assert Colon(tiny.colon_cfg(material="in_situ")).elasticity() == (0.5e6, 0.49)
    assert Colon(tiny.colon_cfg(youngs_modulus=1.0e6, poissons_ratio=0.3)).elasticity() == (1.0e6, 0.3)


def test_youngs_modulus_reaches_a_solid_as_lame_parameters(tiny: TinySim) -> None:
    # E 1.3 MPa and nu 0.3: mu = E / 2.6 = 0.5 MPa, lambda = 2 mu nu / (1 - 2 nu) = 0.75 MPa.
    solid = Colon(tiny.colon_cfg(wall_model="solid", youngs_modulus=1.3e6, poissons_ratio=0.3))
    np.testing.assert_allclose(wall_parameters(solid).moduli, [0.5e6, 0.75e6, 0.0], rtol=1e-6)


def test_youngs_modulus_reaches_a_shell_with_its_thickness(tiny: TinySim) -> None:
    # E 1.3 MPa, nu 0.3 and 2 mm: mu t = 1 kN/m, D = E t^3 / (12 * 0.91).
    moduli = wall_parameters(Colon(tiny.colon_cfg(youngs_modulus=1.3e6, poissons_ratio=0.3))).moduli
    np.testing.assert_allclose(moduli[0], 1.0e3, rtol=1e-4)
    np.testing.assert_allclose(moduli[2], 1.3e6 * 0.002**3 / (12.0 * 0.91), rtol=1e-4)


def test_each_world_takes_its_own_material(sim: Simulation) -> None:
    sim.colon.write_material_to_sim(torch.tensor([1.3e6]), torch.tensor([0.3]), [1])
    np.testing.assert_allclose(sim.moduli[1, 0].item(), 1.0e3, rtol=1e-4)
    assert sim.moduli[0, 0].item() == pytest.approx(5.0e6 * 0.002 / (2.0 * 1.49), rel=1e-4)


def test_a_rigid_colon_does_not_move(tiny: TinySim) -> None:
    sim = tiny("capsule", colon={"rigid": True})
    sim.endoscope.data.joint_pos[:] = torch.tensor([0.0139, 0.0015, 0.1, 0.0, 0.0, 0.0, 1.0])
    sim.forward()
    sim.step(5)
    assert not sim.colon.data.nodal_displacement.any()
    assert sim.endoscope.data.link_force_w.norm() > 0.0


def test_a_solid_takes_no_thickness(tiny: TinySim) -> None:
    with pytest.raises(ValueError, match="ColonCfg.wall_thickness is 0.001 m, expected none with wall_model='solid'"):
        Colon(tiny.colon_cfg(wall_model="solid", wall_thickness=0.001))


def test_density_scales_the_masses(tiny: TinySim) -> None:
    stage, heavy = (wall_parameters(Colon(tiny.colon_cfg(density=rho))).mass for rho in (None, 2000.0))
    density = Colon(tiny.colon_cfg()).stage.material.density
    np.testing.assert_allclose(heavy, stage * 2000.0 / density, rtol=1e-6)


def test_anchor_springs_add_up_to_stiffness_times_length(tiny: TinySim) -> None:
    colon = Colon(tiny.colon_cfg(anchor_stiffness={"sigmoid": 100.0}))
    ring, springs = colon.wall.ring, colon.anchor_springs().stiffness
    assert springs[ring == 5].sum() == pytest.approx(100.0 * 0.0125)  # 62.5 mm: sigmoid; rings stand 12.5 mm apart
    assert springs[ring == 2].sum() == pytest.approx(2.0e4 * 0.0125)  # 25 mm: rectum, from the preset


def test_zero_sets_a_segment_free(tiny: TinySim) -> None:
    colon = Colon(tiny.colon_cfg(anchor_stiffness={"rectum": 0.0}))
    assert not colon.anchor_springs().stiffness[colon.wall.ring == 2].any()


def test_an_unknown_segment_is_named(tiny: TinySim) -> None:
    with pytest.raises(ValueError, match=r"ColonCfg.anchor_stiffness names 'sigmiod'. Did you mean 'sigmoid'"):
        Colon(tiny.colon_cfg(anchor_stiffness={"sigmiod": 1.0}))


def test_an_unknown_material_is_named(tiny: TinySim) -> None:
    with pytest.raises(ValueError, match=r"ColonCfg.material is 'rubber'. Available: clinical, in_situ"):
        Colon(tiny.colon_cfg(material="rubber"))


def test_mobile_until_holds_the_rest(tiny: TinySim) -> None:
    colon = Colon(tiny.colon_cfg(mobile_until=0.1))
    ring = colon.wall.ring
    np.testing.assert_array_equal(np.unique(ring[colon.mobile()]), np.arange(3, 9))  # 37.5 mm to 100 mm


def test_relative_paths_are_looked_for_in_the_assets_folder(tiny: TinySim, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ARCGYM_ASSETS", str(tiny.folder))
    assert Colon(ColonCfg(usd_path="colon.usda")).path == tiny.folder / "colon.usda"
