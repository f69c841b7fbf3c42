# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Chains of a few links, by hand: one step of a spring, a stop, a limited drive, twist, momentum, loads."""

from __future__ import annotations

import math

import numpy as np
import pytest
import warp as wp

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton

from arcgym.sim.scope.scope_solver import SolverArticulatedChain

DT = 0.001
MASS, LENGTH, INERTIA = 0.1, 0.2, (3.0e-4, 4.0e-4, 1.0e-4)
JOINT_INERTIA = INERTIA[0] + MASS * (LENGTH / 2) ** 2
"""Of a link about its lower end and the X axis [kg m^2]: 3e-4 + 0.1 * 0.1^2 = 1.3e-3."""
FREE_AXIS = newton.ModelBuilder.JointDofConfig


def link(builder: newton.ModelBuilder) -> int:
    inertia = wp.mat33(*np.diag(INERTIA).ravel().tolist())
    return builder.add_link(mass=MASS, inertia=inertia, lock_inertia=True)


def turn(axis: str, stiffness: float = 0.0, damping: float = 0.0, **changes: float) -> FREE_AXIS:
    options = {"limit_lower": -10.0, "limit_upper": 10.0, "armature": 0.0, **changes}
    mode = newton.JointTargetMode.POSITION
    return FREE_AXIS(axis=axis, target_ke=stiffness, target_kd=damping, actuator_mode=mode, **options)


class Rig:
    """Worlds with a chain of links end to end along Z, and its solver."""

    def __init__(
        self, joints: list[list[FREE_AXIS]], free: bool = False, slide: FREE_AXIS | None = None, worlds: int = 1
    ) -> None:
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
        ends = wp.vec3(0.0, 0.0, LENGTH / 2), wp.vec3(0.0, 0.0, -LENGTH / 2)
        links, chain = [], []
        if free:
            links.append(link(builder))
            chain.append(builder.add_joint_free(links[0]))
        if slide:
            links.append(link(builder))
            chain.append(builder.add_joint_d6(-1, links[0], linear_axes=[slide]))
        for axes in joints:
            parent = links[-1] if links else -1
            links.append(link(builder))
            top = wp.transform(ends[0] if parent >= 0 else wp.vec3(0.0), wp.quat_identity())
            bottom = wp.transform(ends[1], wp.quat_identity())
            chain.append(
                builder.add_joint_d6(parent, links[-1], angular_axes=axes, parent_xform=top, child_xform=bottom)
            )
        builder.add_articulation(chain)
        scene = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
        scene.replicate(builder, worlds)
        self.model = scene.finalize(device="cpu")
        self.state, self.control = self.model.state(), self.model.control()
        self.solver = SolverArticulatedChain(self.model)
        self.place()

    def place(self, q: list[float] | None = None, qd: list[float] | None = None) -> None:
        """Set joint coordinates and velocities of all worlds."""
        for array, values in ((self.state.joint_q, q), (self.state.joint_qd, qd)):
            if values is not None:
                array.assign(np.tile(np.float32(values), self.model.world_count))
        newton.eval_fk(self.model, self.state.joint_q, self.state.joint_qd, self.state)

    def push(self, body: int, force: tuple = (0.0, 0.0, 0.0), torque: tuple = (0.0, 0.0, 0.0)) -> None:
        wrench = self.state.body_f.numpy()
        wrench[body] = [*force, *torque]
        self.state.body_f.assign(wrench)

    def run(self, steps: int = 1, dt: float = DT) -> np.ndarray:
        """Joint coordinates after some steps."""
        for _ in range(steps):
            self.solver.step(self.state, self.state, self.control, None, dt)
        return self.state.joint_q.numpy()

    @property
    def speed(self) -> np.ndarray:
        return self.state.joint_qd.numpy()


def test_one_step_of_a_damped_spring() -> None:
    """(1.3e-3 + dt c) a = -k q - c v, with k = 2, c = 0.1, q = 0.3, v = 1: a = -0.7 / 1.4e-3."""
    rig = Rig([[turn("X", 2.0, 0.1)]])
    rig.place([0.3], [1.0])
    angle = rig.run()[0]
    expected = 1.0 - DT * 0.7 / 1.4e-3
    assert rig.speed[0] == pytest.approx(expected, rel=1e-5)
    assert angle == pytest.approx(0.3 + DT * expected, rel=1e-5)


def test_period_of_a_spring_pendulum() -> None:
    """2 pi sqrt(1.3e-3 / 0.05) = 1.013 s; a quarter of it later the link passes zero."""
    rig = Rig([[turn("X", 0.05)]])
    rig.place([0.1], [0.0])
    quarter = 0.5 * math.pi * math.sqrt(JOINT_INERTIA / 0.05)
    rig.run(round(quarter / 1e-4), 1e-4)
    assert abs(rig.state.joint_q.numpy()[0]) < 0.001


def test_a_spring_of_any_stiffness_is_stable() -> None:
    rig = Rig([[turn("X", 1.0e6)]] * 3)
    rig.place([0.3, -0.3, 0.3])
    assert np.abs(rig.run(200)).max() < 0.01


def test_drive_and_stop_balance() -> None:
    # Driven to 1 rad with 1 N m/rad, stopped from 0.2 rad on with 9 N m/rad: (1 + 9 * 0.2) / 10.
    rig = Rig([[turn("X", 1.0, 0.1, limit_lower=-0.2, limit_upper=0.2, limit_ke=9.0, limit_kd=0.1)]])
    rig.control.joint_target_q.fill_(1.0)
    assert rig.run(2000)[0] == pytest.approx(0.28, abs=1e-4)


def test_a_drive_never_exceeds_its_limit() -> None:
    # 1000 N/m, a meter away, limited to 2 N: 0.1 kg gains 20 m/s^2.
    slide = turn("Z", 1000.0, 10.0, effort_limit=2.0)
    rig = Rig([], slide=slide)
    rig.control.joint_target_q.fill_(1.0)
    rig.run(5)
    assert rig.speed[0] == pytest.approx(20.0 * 5 * DT, rel=1e-5)
    assert rig.solver.work.drive_force.numpy()[0, 0] == pytest.approx(2.0)


def test_a_drive_pushed_back_does_not_exceed_its_limit_either() -> None:
    # 1.9 N at the start of the step; a body coming at 1 m/s would raise it by (c + dt k) v = 11 N.
    rig = Rig([], slide=turn("Z", 1000.0, 10.0, effort_limit=2.0))
    rig.place([-0.0019], [-1.0])
    rig.run()
    assert rig.solver.work.drive_force.numpy()[0, 0] == pytest.approx(2.0)


def test_twist_angle_is_torque_over_stiffness_for_every_hinge() -> None:
    """0.03 N m through three twists of 0.5 N m/rad: 0.06 rad each, the bending beside them at rest."""
    rig = Rig([[turn("X", 0.5, 0.05), turn("Z", 0.5, 0.05)]] * 3)
    rig.push(2, torque=(0.0, 0.0, 0.03))
    np.testing.assert_allclose(rig.run(3000), [0.0, 0.06] * 3, atol=1e-5)
    turned = 2.0 * math.asin(rig.state.body_q.numpy()[2, 5])
    assert turned == pytest.approx(0.18, abs=1e-4)


def test_power_of_the_joints_is_the_gain_of_energy_with_three_axes() -> None:
    """A drive's constant torque on the middle of three axes that are all turned: its work is the kinetic energy."""
    free = {"limit_lower": -10.0, "limit_upper": 10.0}
    rig = Rig([[turn("X", **free), turn("Y", **free), turn("Z", **free)]])
    rig.place([0.5, 0.4, 0.7], [0.0, 0.0, 0.0])
    torque = 0.01
    rig.control.joint_f.assign(np.array([0.0, torque, 0.0], np.float32))
    start = rig.state.joint_q.numpy()[1]
    angle = rig.run(2000, 1e-4)[1]
    speed = rig.state.body_qd.numpy()[0]
    x, y, z, w = rig.state.body_q.numpy()[0, 3:]
    rot = np.array(wp.quat_to_matrix(wp.quat(x, y, z, w))).reshape(3, 3)
    spin = rot.T @ speed[3:]
    energy = 0.5 * MASS * speed[:3] @ speed[:3] + 0.5 * spin @ (np.array(INERTIA) * spin)
    assert energy == pytest.approx(torque * (angle - start), rel=0.01)


def test_cantilever_bends_by_the_lever_of_every_hinge() -> None:
    """0.01 N across the end of three links of 0.2 m on hinges of 1 N m/rad: 6, 4 and 2 mrad."""
    rig = Rig([[turn("X", 1.0, 0.3)]] * 3)
    rig.push(2, force=(0.0, -0.01, 0.0), torque=(0.001, 0.0, 0.0))  # from the center to the end: 0.1 m
    np.testing.assert_allclose(rig.run(5000), [0.006, 0.004, 0.002], rtol=2e-3)


def test_poses_are_those_of_newtons_kinematics() -> None:
    rig = Rig([[turn("X"), turn("Z")], [turn("Y")], [turn("X"), turn("Y"), turn("Z")]], free=True)
    angles, rates = [0.3, 0.2, -0.4, 0.5, 0.4, 0.1], [1.0, -2.0, 0.5, 1.0, -1.0, 2.0]
    rig.place([0.1, 0.2, 0.3, 0.0, 0.6, 0.0, 0.8, *angles], [0.3] * 6 + rates)
    rig.run(20)
    pose, twist = rig.state.body_q.numpy(), rig.state.body_qd.numpy()
    rig.place()
    np.testing.assert_allclose(pose, rig.state.body_q.numpy(), atol=1e-5)
    np.testing.assert_allclose(twist, rig.state.body_qd.numpy(), atol=1e-4)


def test_a_free_chain_keeps_its_momentum() -> None:
    rig = Rig([[turn("X", 0.5)], [turn("Y", 0.5), turn("Z", 0.5)]], free=True)
    rig.place([0.0] * 6 + [1.0, 0.4, -0.3, 0.2], [0.5, 0.0, 0.0, 1.0, 2.0, 0.5, 3.0, -2.0, 1.0])
    before = rig.state.body_qd.numpy()[:, :3].sum(axis=0)
    rig.run(2000, 1e-4)
    np.testing.assert_allclose(rig.state.body_qd.numpy()[:, :3].sum(axis=0), before, atol=0.01)


def test_a_free_body_spins_on() -> None:
    """Torque-free: the angular momentum R I R^T w stays, within the first-order error of the step."""
    rig = Rig([], free=True)
    rig.place([0.0] * 6 + [1.0], [0.0, 0.0, 0.0, 3.0, 2.0, 5.0])
    rig.run(1000, 1e-4)
    x, y, z, w = rig.state.body_q.numpy()[0, 3:]
    rot = np.array(wp.quat_to_matrix(wp.quat(x, y, z, w))).reshape(3, 3)
    momentum = rot @ np.diag(INERTIA) @ rot.T @ rig.state.body_qd.numpy()[0, 3:]
    np.testing.assert_allclose(momentum, np.array(INERTIA) * [3.0, 2.0, 5.0], atol=1e-5)


def test_a_pushed_free_body_accelerates_by_its_mass() -> None:
    rig = Rig([], free=True)
    rig.push(0, force=(0.2, 0.0, 0.0))
    rig.run(100)
    assert rig.speed[0] == pytest.approx(0.2 / MASS * 0.1, rel=1e-4)
    assert rig.state.joint_q.numpy()[0] == pytest.approx(0.5 * 2.0 * 0.1**2, rel=0.02)


def test_a_load_that_resists_acceleration_adds_to_the_mass() -> None:
    """Force 1 N less 0.3 kg times the acceleration, on 0.1 kg: 2.5 m/s^2."""
    rig = Rig([], free=True)
    rig.solver.loads.wrench.assign(np.array([[[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]]], np.float32))
    rig.solver.loads.ll.assign(0.3 * np.eye(3, dtype=np.float32)[None, None])
    rig.run()
    assert rig.speed[0] == pytest.approx(2.5 * DT, rel=1e-5)
    assert rig.solver.work.acc_lin.numpy()[0, 0, 0] == pytest.approx(2.5, rel=1e-5)


def test_worlds_do_not_touch_one_another() -> None:
    joints = [[turn("X", 1.0), turn("Z", 1.0)]] * 2
    alone, pair = Rig(joints), Rig(joints, worlds=2)
    for rig in (alone, pair):
        rig.push(1, force=(0.1, 0.2, 0.0))
    pair.push(3, force=(-5.0, 1.0, 2.0))
    np.testing.assert_array_equal(alone.run(20), pair.run(20)[:4])


def test_branches_are_refused() -> None:
    builder = newton.ModelBuilder()
    links = [link(builder) for _ in range(3)]
    joints = [builder.add_joint_revolute(parent, child) for parent, child in ((-1, 0), (0, 1), (0, 2))]
    builder.add_articulation(joints)
    assert links == [0, 1, 2]
    with pytest.raises(ValueError, match=r"Joint 2 \(REVOLUTE\) joins links 0 and 2 instead of 1 and 2"):
        SolverArticulatedChain(builder.finalize(device="cpu"))


def test_ball_joints_are_refused() -> None:
    builder = newton.ModelBuilder()
    link(builder)
    builder.add_articulation([builder.add_joint_ball(-1, 0)])
    with pytest.raises(ValueError, match=r"Joint 0 \(BALL\) is of a kind .* takes REVOLUTE, PRISMATIC, D6"):
        SolverArticulatedChain(builder.finalize(device="cpu"))
