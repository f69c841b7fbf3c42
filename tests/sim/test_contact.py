# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A capsule of radius 5 mm and 20 mm length placed by hand in the tube, parallel to one of its eight flat sides."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from static_force import static_force
from tiny_sim import TinySim, steps

from arcgym.assets import TipPullCfg
from arcgym.sim import ContactCfg, Simulation
from arcgym.utils.math import quat_apply

APOTHEM = 0.020 * math.cos(math.pi / 8)
"""Distance of the tube's flat sides from its axis [m]."""
REACH = 0.005 + ContactCfg().wall_radius
"""Distance from the capsule's axis at which it touches [m]."""
SIDE = np.array([math.cos(math.pi / 8), math.sin(math.pi / 8), 0.0])
"""Direction of the side between the vertices at 0 and 45 degrees."""


@pytest.fixture(scope="module")
def sim(tiny_sim: TinySim) -> Simulation:
    return tiny_sim("capsule", colon={"wall_model": "solid"})  # its inner faces are the lumen's


def place(sim: Simulation, depth: float, direction: np.ndarray = SIDE, z: float = 0.1) -> None:
    """Put the capsule so that it overlaps the side in ``direction`` by ``depth`` [m]; find its contacts."""
    position = (APOTHEM - REACH + depth) * direction + [0.0, 0.0, z]
    sim.endoscope.data.joint_pos[0] = torch.tensor([*position, 0.0, 0.0, 0.0, 1.0])
    sim.endoscope.data.joint_vel.zero_()
    sim.forward()
    sim.contact.memory["contact_slide"].zero_()
    sim.coupling.find_contacts()


def wall_force(sim: Simulation, link_velocity: tuple = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Force of the wall on the capsule [N], at the start of a substep."""
    sim.endoscope.data.joint_vel[0, :3] = torch.tensor(link_velocity)
    sim.forward()
    sim.coupling.load_contacts(0.0, 1.0e-9)
    return sim.coupling.solver.loads.wrench.numpy()[0, 0, :3]


def force_on_wall(sim: Simulation) -> np.ndarray:
    """Force on each wall vertex at rest [N], shape (V, 3): contact alone, friction left out."""
    return static_force(sim).numpy()[:, 0]


def count(sim: Simulation) -> int:
    return int(sim.contact.records.start.numpy()[0, 1])


def touching(sim: Simulation) -> float:
    """Sum of the weights of the contacts that touch."""
    records, n = sim.contact.records, count(sim)
    return float(records.weight.numpy()[:n][records.distance.numpy()[:n] < REACH].sum())


def test_no_records_in_the_middle_of_the_lumen(sim: Simulation) -> None:
    place(sim, depth=-0.012)
    assert count(sim) == 0
    np.testing.assert_array_equal(wall_force(sim), 0.0)


def test_records_without_force_just_before_touching(sim: Simulation) -> None:
    place(sim, depth=-0.0005)
    assert count(sim) > 0
    np.testing.assert_array_equal(wall_force(sim), 0.0)


def test_force_is_stiffness_times_depth_for_each_record(sim: Simulation) -> None:
    place(sim, depth=1.0e-4)
    records, n = sim.contact.records, count(sim)
    depth = np.maximum(REACH - records.distance.numpy()[:n], 0.0)
    assert depth.max() == pytest.approx(1.0e-4, rel=0.01)
    expected = 2000.0 * (records.weight.numpy()[:n] * depth).sum()  # 2000 N/m * 0.1 mm = 0.2 N for a full contact
    np.testing.assert_allclose(wall_force(sim), -expected * SIDE, atol=0.02 * expected)


def test_force_does_not_jump_as_a_capsule_slides_along_the_faces(sim: Simulation) -> None:
    forces = []
    for z in np.arange(0.09, 0.115, 2.5e-4):  # two rings
        place(sim, depth=1.0e-4, z=z)
        forces.append(np.linalg.norm(wall_force(sim)))
    assert np.abs(np.diff(forces)).max() < 0.1 * np.mean(forces)


def test_force_does_not_jump_as_a_capsule_tilts(sim: Simulation) -> None:
    forces = []
    for tilt in np.linspace(-0.02, 0.02, 41):  # one end 0.1 mm deeper than the other, in steps of 5 um
        place(sim, depth=3.0e-4)
        half = 0.5 * tilt
        axis = np.cross(SIDE, [0.0, 0.0, 1.0])
        sim.endoscope.data.joint_pos[0, 3:] = torch.tensor([*(np.sin(half) * axis), np.cos(half)])
        sim.forward()
        sim.coupling.find_contacts()
        forces.append(np.linalg.norm(wall_force(sim)))
    assert np.abs(np.diff(forces)).max() < 0.05 * np.mean(forces)


def test_record_normals_point_outwards(sim: Simulation) -> None:
    place(sim, depth=1.0e-4)
    normals = sim.contact.records.normal.numpy()[: count(sim)]
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-5)
    assert (normals @ SIDE).min() > math.cos(math.pi / 8) - 1e-5  # at most half way to the next side's


def test_each_touch_lies_on_the_lumen_surface(sim: Simulation) -> None:
    place(sim, depth=1.0e-4)
    records = sim.contact.records
    faces, bary = records.corners.numpy()[: count(sim)], records.bary.numpy()[: count(sim)]
    points = np.einsum("nk,nki->ni", bary, sim.nodal_pos.numpy()[:, 0][faces])
    near = records.distance.numpy()[: count(sim)] < REACH
    np.testing.assert_allclose(points[near] @ SIDE, APOTHEM, atol=1e-6)
    np.testing.assert_allclose(bary.sum(axis=1), 1.0, atol=1e-5)


def test_action_equals_reaction(sim: Simulation) -> None:
    place(sim, depth=3.0e-4)
    np.testing.assert_allclose(force_on_wall(sim).sum(axis=0), -wall_force(sim), rtol=1e-3, atol=1e-4)


def test_a_capsule_in_a_corner_is_held_by_both_sides(sim: Simulation) -> None:
    # Axis parallel to the corner at angle 0, at 0.2 mm depth in the sides at +-22.5 degrees.
    corner = np.array([1.0, 0.0, 0.0])
    place(sim, depth=(REACH - APOTHEM) + (APOTHEM - REACH + 2.0e-4) / SIDE[0], direction=corner)
    normals = sim.contact.records.normal.numpy()[: count(sim)]
    assert set(np.sign(normals[:, 1])) == {-1.0, 1.0}
    assert wall_force(sim)[0] == pytest.approx(-touching(sim) * 0.4 * SIDE[0], rel=0.02)  # 2000 N/m * 0.2 mm = 0.4 N
    assert abs(wall_force(sim)[1]) < 0.2 * abs(wall_force(sim)[0])


def test_a_capsule_that_has_just_gone_through_the_wall_is_pushed_back_in(sim: Simulation) -> None:
    place(sim, depth=REACH + 0.001)  # its axis is 1 mm beyond the wall
    assert wall_force(sim) @ SIDE < -2000.0 * REACH


def test_a_capsule_outside_comes_back(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule")
    place(sim, depth=REACH + 0.002)
    sim.step(steps(sim, 0.2))
    dent = np.abs(sim.nodal_pos.numpy()[:, 0] - sim.colon.wall.points).max()  # its drive may press it on the wall
    assert sim.endoscope.data.body_pos_w[0, 0].numpy() @ SIDE < APOTHEM - REACH + 5e-4 + dent


def slid(sim: Simulation, by: float) -> np.ndarray:
    """Force of the wall on a capsule that has come ``by`` [m] along it since it touched [N]."""
    place(sim, depth=1.0e-5)
    sim.contact.memory["contact_slide"].view(-1, 3)[:] = torch.tensor([0.0, 0.0, by])
    return wall_force(sim)


def test_a_capsule_that_slides_feels_coulomb_friction(sim: Simulation) -> None:
    force = slid(sim, by=0.001)  # 0.1 times the normal force, against the motion
    assert force[2] == pytest.approx(0.1 * force @ SIDE, rel=1e-3)


def test_friction_holds_elastically_before_it_slides(sim: Simulation) -> None:
    # Two full contacts at 10 um depth bear 0.02 N each; half of 0.1 * 0.02 N along the wall, of its springs.
    force = slid(sim, by=0.001 / sim.cfg.contact.friction_stiffness)
    assert force[2] == pytest.approx(-0.001 * touching(sim), rel=3e-3)  # positions are floats
    assert abs(force[2]) < 0.1 * abs(force @ SIDE)


def test_a_link_without_a_ring_is_searched_along_the_whole_colon(sim: Simulation) -> None:
    place(sim, depth=1.0e-4, z=0.15)
    sim.contact.ring.fill_(-1)
    sim.coupling.find_contacts()
    assert sim.contact.ring.numpy()[0, 0] == 12  # 150 mm / 12.5 mm
    assert count(sim) >= 1


def brute_force(sim: Simulation, limit: float) -> set[int]:
    """Faces within ``limit`` [m] of the capsule's axis, by sampling both densely; the axis is in the lumen."""
    pose = sim.state.body_q.numpy()[0]
    half = float(sim.contact.links.half_length.numpy()[0])
    turn = quat_apply(torch.tensor(pose[None, 3:]), torch.tensor([[0.0, 0.0, 1.0]]))[0].numpy()
    axis = pose[:3] + np.linspace(-half, half, 41)[:, None] * turn
    grid = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, 41)] * 2), axis=2).reshape(-1, 2)
    grid = grid[grid.sum(axis=1) <= 1.0 + 1e-9]
    bary = np.column_stack([1.0 - grid.sum(axis=1), grid])
    corners = sim.nodal_pos.numpy()[:, 0][sim.contact.surface.faces.numpy()]
    near = np.linalg.norm(corners.mean(axis=1) - pose[:3], axis=1) < 0.04
    found = set()
    for face in np.flatnonzero(near):
        points = bary @ corners[face]
        if np.linalg.norm(points[:, None] - axis[None], axis=2).min() < limit:
            found.add(int(face))
    return found


@pytest.mark.parametrize("gathered", [1.0, 0.25])
def test_the_search_finds_every_face_near_a_link_however_the_wall_is_gathered(
    tiny_sim: TinySim, gathered: float
) -> None:
    # The tube between 0.05 m and 0.15 m is pushed together to a quarter: rings 3 mm apart, eight beside the capsule.
    sim = tiny_sim("capsule", colon={"wall_model": "solid"})
    rest = sim.colon.wall.points.astype(np.float32)
    height = np.interp(
        rest[:, 2], [0.0, 0.05, 0.15, 1.0], [0.0, 0.05, 0.05 + 0.1 * gathered, 1.0 - 0.1 * (1 - gathered)]
    )
    sim.nodal_pos.assign(np.column_stack([rest[:, :2], height])[:, None])
    place(sim, depth=5.0e-4, z=0.055 + 0.03 * gathered)
    records, n = sim.contact.records, count(sim)
    found, limit = records.distance.numpy()[:n], REACH + ContactCfg().search_gap
    expected = brute_force(sim, limit - 2e-4)
    assert len(expected) >= 3 and expected <= set(records.face.numpy()[:n].tolist())
    assert found.max() < limit and sim.contact.shortage() is None


def test_contacts_beyond_the_capacity_are_counted(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", colon={"wall_model": "solid"}, contact=ContactCfg(patch_capacity=1))
    place(sim, depth=5.0e-4)
    assert count(sim) <= 6  # one patch of six faces
    dropped = int(sim.dropped_contacts[0])
    assert dropped > 0 and sim.contact.shortage() == (
        f"{dropped} contacts found no room in 1 of 1 worlds, whose forces are wrong: "
        "raise env.sim.contact.capacity (40) and patch_capacity (1)."
    )


def resting(tiny_sim: TinySim, along: float) -> Simulation:
    """Return a capsule on a rigid wall after 0.25 s under its weight across the side and ``along`` times that along it.

    It cannot turn: it has one contact, at its deeper end, and would rock.
    """
    loose = TipPullCfg(stiffness=1.0e-3, damping=0.0, angular_stiffness=1.0, angular_damping=0.01, torque_limit=10.0)
    pull = tuple(9.81 * (SIDE + [0.0, 0.0, along]))
    rigid = {"mobile_until": 0.0, "wall_model": "solid"}
    sim = tiny_sim("capsule", gravity=pull, colon=rigid, scope={"actuators": {"tip": loose}})
    place(sim, depth=1.0e-5)
    sim.step(steps(sim, 0.25))
    return sim


def test_a_resting_capsule_dents_by_its_weight_over_the_stiffness(tiny_sim: TinySim) -> None:
    sim = resting(tiny_sim, along=0.0)
    depth = sim.endoscope.data.body_pos_w[0, 0].numpy() @ SIDE - (APOTHEM - REACH)
    assert depth * 2000.0 * touching(sim) == pytest.approx(0.005 * 9.81, rel=0.1)
    np.testing.assert_allclose(sim.endoscope.data.link_force_w[0, 0].numpy(), -0.005 * 9.81 * SIDE, atol=1e-4)


def test_a_pull_below_the_friction_does_not_move_it(tiny_sim: TinySim) -> None:
    sim = resting(tiny_sim, along=0.05)  # friction holds 0.1 times the weight
    assert abs(sim.endoscope.data.body_lin_vel_w[0, 0, 2].item()) < 1e-5
    assert sim.endoscope.data.link_force_w[0, 0, 2].item() == pytest.approx(-0.05 * 0.005 * 9.81, rel=0.02)


def test_a_pull_above_the_friction_accelerates_it_by_the_rest(tiny_sim: TinySim) -> None:
    sim = resting(tiny_sim, along=0.3)  # (0.3 - 0.1) g for 0.25 s
    assert sim.endoscope.data.body_lin_vel_w[0, 0, 2].item() == pytest.approx(0.2 * 9.81 * 0.25, rel=0.1)


@pytest.mark.parametrize(("depth", "penetrated"), [(0.7, False), (0.8, True), (1.1, True)])
def test_a_link_penetrates_the_wall_where_its_axis_comes_close_to_it(
    sim: Simulation, depth: float, penetrated: bool
) -> None:
    place(sim, depth * REACH)
    sim.scope_readout.clear()
    wall_force(sim)
    assert sim.wall_penetrated.tolist() == [penetrated]


@pytest.mark.parametrize(("share", "ratio"), [(2.0 / 3.0, 0.4387), (0.0, 1.0)])
def test_contacts_of_a_soft_shell_give_as_its_tissue_does(tiny_sim: TinySim, share: float, ratio: float) -> None:
    """0.5 MPa, 2 mm and 0.49: 2/3 * 1000 / (1 - 0.49^2) = 877.3 N/m of 2000; ten times the modulus has all of them."""
    contact = ContactCfg(tissue_share=share)
    sim = tiny_sim("capsule", num_envs=2, colon={"youngs_modulus": 5.0e5}, contact=contact)
    sim.colon.write_stiffness_scale_to_sim(torch.tensor([1.0, 10.0]))
    sim.endoscope.data.joint_pos[:] = torch.tensor([*(0.014 * SIDE + [0.0, 0.0, 0.1]), 0.0, 0.0, 0.0, 1.0])
    sim.forward()
    sim.coupling.find_contacts()
    soft, hard = sim.contact.records.weight.numpy().reshape(2, -1).sum(axis=1)
    assert hard > 0.0 and soft / hard == pytest.approx(ratio, rel=1e-3)
