# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The endoscope as an asset: names, rest pose by hand, commands, writes by world."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from tiny_sim import TinySim

from arcgym.anatomy.segments import SEGMENTS
from arcgym.assets.endoscope_spec import REST_TIP_HEIGHT
from arcgym.sim import Simulation

RADIUS = 0.0066
"""Radius of the proximal scope's last link [m]; its round end stands out by as much."""


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("endoscope"))


@pytest.fixture
def sim(tiny: TinySim) -> Simulation:
    return tiny(num_envs=2)


def test_shapes_of_a_scope_with_a_shaft(sim: Simulation) -> None:
    scope, data = sim.endoscope, sim.endoscope.data
    assert (scope.num_bodies, scope.num_joints, list(scope.actuators)) == (6, 13, ["base", "bending"])
    bends = [f"bend_{axis}_{hinge}" for hinge in range(1, 6) for axis in "xy"]
    assert scope.joint_names == ["slide", "roll", *bends[:8], "twist_4", *bends[8:]]
    assert scope.body_names == [f"link_{i}" for i in range(6)]
    assert data.joint_pos.shape == data.joint_vel.shape == data.joint_pos_target.shape == (2, 13)
    assert data.body_pos_w.shape == data.body_lin_vel_w.shape == data.link_force_w.shape == (2, 6, 3)
    assert data.body_quat_w.shape == (2, 6, 4) and data.link_force_peak.shape == (2, 6)
    assert data.tip_pos_w.shape == data.tip_lumen_direction_w.shape == data.tip_pull_force_w.shape == (2, 3)
    assert data.bending.shape == (2, 2) and data.base_force.shape == data.tip_arc_length.shape == (2,)


def test_shapes_of_a_capsule(tiny: TinySim) -> None:
    scope = tiny("capsule", num_envs=2).endoscope
    assert (scope.num_bodies, scope.num_joints) == (1, 7)
    assert scope.data.joint_pos.shape == (2, 7) and scope.data.joint_vel.shape == (2, 6)


def test_rest_pose_of_the_proximal_scope(sim: Simulation) -> None:
    # The last link ends at the rest height; its round end adds a radius.
    data, front = sim.endoscope.data, REST_TIP_HEIGHT + RADIUS
    torch.testing.assert_close(data.tip_pos_w, torch.tensor([[0.0, 0.0, front]] * 2), atol=1e-6, rtol=0.0)
    assert data.inserted_length.tolist() == pytest.approx([front] * 2, abs=1e-6)
    assert data.tip_arc_length.tolist() == pytest.approx([front] * 2, abs=1e-6)
    assert data.tip_centerline_distance.tolist() == pytest.approx([0.0] * 2, abs=1e-6)
    assert data.tip_segment.tolist() == [SEGMENTS.index("rectum")] * 2
    torch.testing.assert_close(data.tip_lumen_direction_w, torch.tensor([[0.0, 0.0, 1.0]] * 2))
    torch.testing.assert_close(data.root_pos_w, data.body_pos_w[:, 0])


def test_camera_sits_on_the_axis_and_looks_forward(sim: Simulation) -> None:
    x, y, z, *quaternion = sim.endoscope.camera_pose_wp.numpy()[0]
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert 0.0 < sim.endoscope.data.tip_pos_w[0, 2].item() - z < RADIUS
    np.testing.assert_allclose(np.abs(quaternion), [0.0, 1.0, 0.0, 0.0], atol=1e-6)  # -Z of the camera along +Z


@pytest.mark.parametrize(
    ("height", "segment"), [(0.030, "rectum"), (0.050, "sigmoid"), (0.110, "descending"), (0.170, "transverse")]
)
def test_a_capsule_knows_where_it_is(tiny: TinySim, height: float, segment: str) -> None:
    # Segments of 40 mm on a centerline of 5 mm steps; the front of the capsule lies 10 mm ahead of its center.
    sim = tiny("capsule")
    sim.endoscope.data.joint_pos[0, :3] = torch.tensor([0.003, 0.0, height - 0.010])
    sim.contact.ring.fill_(-1)
    sim.forward()
    assert sim.endoscope.data.tip_arc_length.item() == pytest.approx(height, abs=1e-5)
    assert sim.endoscope.data.inserted_length.item() == pytest.approx(height, abs=1e-5)
    assert sim.endoscope.data.tip_centerline_distance.item() == pytest.approx(0.003, abs=1e-5)
    assert sim.endoscope.data.tip_segment.item() == SEGMENTS.index(segment)


def test_tip_velocity_includes_the_turn_of_its_link(tiny: TinySim) -> None:
    sim = tiny("capsule")
    sim.endoscope.data.joint_vel[0] = torch.tensor([0.0, 0.0, 0.02, 0.0, 3.0, 0.0])
    sim.forward()
    # The front is 10 mm ahead of the center: 3 rad/s about Y moves it by 30 mm/s along X.
    expected = torch.tensor([[0.03, 0.0, 0.02]])
    torch.testing.assert_close(sim.endoscope.data.tip_lin_vel_w, expected, atol=1e-6, rtol=0.0)
    torch.testing.assert_close(sim.endoscope.data.tip_ang_vel_w, torch.tensor([[0.0, 3.0, 0.0]]))


def test_joint_positions_share_memory_with_the_simulation(sim: Simulation) -> None:
    sim.endoscope.data.joint_pos[1, 0] = 0.01
    sim.forward()
    assert sim.state.joint_q.numpy()[13] == np.float32(0.01)
    heights = sim.endoscope.data.tip_pos_w[:, 2]
    assert (heights[1] - heights[0]).item() == pytest.approx(0.01, abs=1e-6)


def test_a_proximal_scope_cannot_be_pulled(sim: Simulation) -> None:
    with pytest.raises(ValueError, match=r"proximal_6.usda has no actuator 'tip'; .* has \['base', 'bending'\]"):
        sim.endoscope.set_tip_velocity_command(torch.zeros(2, 3), torch.zeros(2, 3))


@pytest.mark.parametrize("kind", ["capsule", "magnetic"])
@pytest.mark.parametrize(("method", "drive"), [("set_insertion_command", "base"), ("set_bending_command", "bending")])
def test_a_pulled_scope_cannot_be_pushed(tiny: TinySim, kind: str, method: str, drive: str) -> None:
    scope = tiny(kind).endoscope
    with pytest.raises(ValueError, match=f"has no actuator '{drive}'; .* has \\['tip'\\]"):
        getattr(scope, method)(torch.zeros(1), torch.zeros(1))


def test_commands_move_their_own_world(sim: Simulation) -> None:
    sim.endoscope.set_insertion_command(torch.tensor([0.0, 0.05]), torch.zeros(2))
    sim.endoscope.set_bending_command(torch.zeros(2), torch.tensor([0.1, 0.0]))
    sim.step(96)
    still, pushed = sim.endoscope.data.inserted_length - (REST_TIP_HEIGHT + RADIUS)
    assert abs(still) < 1e-4 and pushed > 0.008
    torch.testing.assert_close(sim.endoscope.data.bending, torch.tensor([[0.0, 0.1], [0.0, 0.0]]))


def test_friction_is_written_by_world(sim: Simulation) -> None:
    sim.endoscope.write_friction_to_sim(torch.tensor([0.3]), [1])
    np.testing.assert_allclose(sim.contact.friction.numpy(), [0.1, 0.3])


def test_friction_slows_its_own_world_only(tiny: TinySim) -> None:
    sim = tiny("capsule", num_envs=2)
    sim.endoscope.write_friction_to_sim(torch.tensor([0.0, 0.5]))
    # Two capsules slide along a flat side of the tube, 0.1 mm deep.
    side = torch.tensor([np.cos(np.pi / 8), np.sin(np.pi / 8)], dtype=torch.float32)
    sim.endoscope.data.joint_pos[:, :2] = side * (0.020 * np.cos(np.pi / 8) - 0.0054)
    sim.endoscope.data.joint_pos[:, 2] = 0.1
    sim.endoscope.data.joint_vel[:, 2] = 0.05
    sim.forward()
    sim.step(2)
    assert (sim.endoscope.data.link_force_w[1, 0, 2] < -0.01).item()
    assert abs(sim.endoscope.data.link_force_w[0, 0, 2].item()) < 1e-3


def test_rigidity_overrides_scale_the_hinges(tiny: TinySim) -> None:
    plain, soft = (tiny(scope=change).model.joint_target_ke.numpy() for change in ({}, {"shaft_rigidity": 0.0125}))
    # Root, two axes of two shaft hinges of 0.025 N m^2, and the bending section.
    np.testing.assert_allclose(soft[2:6], 0.5 * plain[2:6], rtol=1e-5)
    np.testing.assert_array_equal(soft[6:], plain[6:])


def test_torsional_rigidity_scales_the_twists(tiny: TinySim) -> None:
    plain, soft = (tiny(scope=c).model.joint_target_ke.numpy() for c in ({}, {"torsional_rigidity": 0.21}))
    twists = [10]
    np.testing.assert_allclose(soft[twists], 0.5 * plain[twists], rtol=1e-5)
    np.testing.assert_array_equal(np.delete(soft, twists), np.delete(plain, twists))


def test_the_insertion_force_limit_is_the_drives(tiny: TinySim) -> None:
    effort = tiny(scope={"drives": {"base": {"force_limit": 3.0}}}).model.joint_effort_limit.numpy()
    assert effort[:2].tolist() == [3.0, 1.0]


def test_masses_are_scaled(tiny: TinySim) -> None:
    sim = tiny(mass_scaling=2.0)
    np.testing.assert_allclose(sim.model.body_mass.numpy(), 2.0 * sim.endoscope.stage.link_mass, rtol=1e-5)
