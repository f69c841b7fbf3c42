# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The kernel that solves a chain by a warp of a GPU against the plain ones, on the same GPU."""

from __future__ import annotations

from unittest import mock

import numpy as np
import pytest
import warp as wp
from load_rows import write_rows

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton

from arcgym.sim.scope import scope_solver
from arcgym.sim.scope.scope_solver import SolverArticulatedChain

pytestmark = pytest.mark.skipif(not wp.is_cuda_available(), reason="needs CUDA")

WORLDS, LINKS, LENGTH, DT = 3, 70, 0.02, 0.001
AXES = ("X", "Y", "Z")


def model(free: bool, generator: np.random.Generator) -> newton.Model:
    """Links end to end along Z, 20 mm and 5 g each, with none to three axes between them, on a slide or free."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    axis, joints = newton.ModelBuilder.JointDofConfig, []
    top, bottom = (wp.transform(wp.vec3(0.0, 0.0, z), wp.quat_identity()) for z in (LENGTH / 2, -LENGTH / 2))
    inertia = wp.mat33(*np.diag([3.0e-7, 3.0e-7, 1.0e-7]).ravel().tolist())
    for number in range(LINKS):
        link = builder.add_link(mass=0.005, inertia=inertia, lock_inertia=True)
        options = {"limit_lower": -0.5, "limit_upper": 0.5, "limit_ke": 2.0, "armature": 2.0e-5, "effort_limit": 0.2}
        options |= {"target_ke": 0.5, "target_kd": 0.01, "actuator_mode": newton.JointTargetMode.POSITION}
        if number == 0 and free:
            joints.append(builder.add_joint_free(link))
        elif number == 0:
            joints.append(builder.add_joint_d6(-1, link, linear_axes=[axis(axis="Z", **options)]))
        else:
            turns = [axis(axis=name, **options) for name in AXES[: generator.integers(4)]]
            joint = builder.add_joint_d6(link - 1, link, angular_axes=turns, parent_xform=top, child_xform=bottom)
            joints.append(joint)
    builder.add_articulation(joints)
    scene = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    scene.replicate(builder, WORLDS)
    return scene.finalize(device="cuda:0")


def loaded(solver: SolverArticulatedChain, generator: np.random.Generator) -> tuple[newton.State, newton.Control]:
    """Bend, move and load the chain at random; return its state and control."""
    chain, state, control = solver.chain, solver.model.state(), solver.model.control()
    links, dofs, coords = chain.links, chain.dofs, chain.coords
    angles = generator.normal(0.0, 0.3, (WORLDS, coords))
    if chain.free:
        angles[:, 3:7] /= np.linalg.norm(angles[:, 3:7], axis=1, keepdims=True)
    state.joint_q.assign(np.float32(angles.ravel()))
    state.joint_qd.assign(np.float32(generator.normal(0.0, 0.5, WORLDS * dofs)))
    control.joint_target_q.assign(np.float32(generator.normal(0.0, 0.3, WORLDS * coords)))
    control.joint_f.assign(np.float32(generator.normal(0.0, 0.02, WORLDS * dofs)))
    solver.forward(state, wp.ones(WORLDS, dtype=wp.bool, device="cuda:0"))
    scale = np.float32([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])
    state.body_f.assign(np.float32(generator.normal(0.0, 0.05, (WORLDS * links, 6)) * scale))
    solver.resistance.assign(np.float32(generator.uniform(0.0, 0.01, (links, WORLDS, 6)) * scale**2))
    free = generator.uniform(size=(links, WORLDS, 1)) < 0.3  # links that touch nothing
    wrench = np.where(free, 0.0, np.float32(generator.normal(0.0, 0.1, (links, WORLDS, 6)) * scale))
    root = generator.normal(0.0, 0.05, (links, WORLDS, 6, 6)) * scale[:, None]
    whole = np.where(free[..., None], 0.0, np.float32(root @ root.swapaxes(2, 3)))
    loads = {"ll": whole[..., :3, :3], "la": whole[..., :3, 3:], "aa": whole[..., 3:, 3:], "wrench": wrench}
    if solver.by_warp:
        write_rows(solver.loads, **loads)
        return state, control
    for name, values in loads.items():
        getattr(solver.loads, name).assign(np.ascontiguousarray(np.float32(values)))
    return state, control


@pytest.mark.parametrize("free", [False, True], ids=["slide", "free"])
def test_a_warp_solves_a_chain_as_plain_kernels_do(free: bool) -> None:
    """70 links, of which some have no joint, are prepared in three chunks; a third of the drives is at its limit.

    Places of up to a meter round by 6e-8 m. Levers of 10 mm are their differences, and rates follow from levers.
    """
    found = []
    for by_warp in (True, False):
        generator = np.random.default_rng(5)
        with mock.patch.object(scope_solver, "fits", lambda links, dofs, by_warp=by_warp: by_warp):
            solver = SolverArticulatedChain(model(free, generator))
        assert solver.by_warp == by_warp
        state, control = loaded(solver, generator)
        load = wp.ones(WORLDS * LINKS, dtype=wp.vec3, device="cuda:0")
        solver.prepare(state, control, DT)
        solver.move(state, state, control, DT, load, 0.25)
        work, arrays = solver.work, [state.joint_q, state.joint_qd, state.body_q, state.body_qd, load]
        arrays += [work.lever, work.acc_lin, work.acc_ang, work.drive, work.drive_inertia, work.drive_force]
        found.append([array.numpy() for array in arrays])
    limited = (found[0][9] == 0.0).mean()
    assert 0.1 < limited < 0.9, limited
    names = "joint_q joint_qd body_q body_qd load lever acc_lin acc_ang drive drive_inertia drive_force".split()
    for name, by_warp, plain in zip(names, *found, strict=True):
        bound = 1.0e-5 if name in ("joint_q", "body_q", "load", "drive", "drive_inertia") else 1.0e-4
        np.testing.assert_allclose(by_warp, plain, rtol=0.0, atol=bound * np.abs(plain).max(), err_msg=name)
