# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Stiffness of the wall's bands in the modes of their rings, at rest and in a dented tube."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
import torch
import warp as wp
from small_strain import stretching_stiffness, tet_stiffness
from static_force import static_force
from tiny_sim import TinySim

from arcgym.assets.shell_geometry import shell_geometry
from arcgym.sim import Simulation
from arcgym.sim.wall import coarse_kernels
from arcgym.sim.wall.ring_modes import MODES
from arcgym.sim.wall.wall_solver import wall_contacts

NO_ANCHORS = dict.fromkeys(("rectum", "sigmoid", "descending", "splenic", "transverse"), 0.0)
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
"""A rotation."""


def make(tiny_sim: TinySim, kind: str = "shell") -> Simulation:
    return tiny_sim("capsule", colon={"wall_model": kind, "youngs_modulus": 5.0e5, "anchor_stiffness": NO_ANCHORS})


def dented(sim: Simulation) -> np.ndarray:
    """The tube bent by 60 degrees, with a dent of 8 mm in its middle and pulled longer by up to 20 %, shape (V, 3)."""
    x, y, z = sim.colon.data.nodal_pos_w[0].double().numpy().T
    dent = 0.008 * np.exp(-(((z - 0.1) / 0.02) ** 2)) * np.clip(x / 0.02, 0.0, 1.0)
    x, z = x - dent, 1.1 * z + 0.02 * z / 0.2 * np.sin(3.0 * y / 0.02)
    angle, radius = z / 0.2, 0.2 - x
    return np.column_stack([0.2 - radius * np.cos(angle), y, radius * np.sin(angle)])


def matrix(sim: Simulation, points: np.ndarray) -> np.ndarray:
    """Stiffness between all unknowns of all rings [N/m], shape (9 R, 9 R)."""
    sim.nodal_pos.assign(points[:, None].astype(np.float32))
    solver, rings = sim.wall, sim.wall.ring_count
    inputs, outputs = [sim.nodal_pos, solver.rings, solver.loads], [solver.axes, solver.shift]
    wp.launch(coarse_kernels.place_rings, (rings, 1), inputs=inputs, outputs=outputs)
    inputs = [sim.nodal_pos, solver.elements.data, solver.rings, solver.axes, solver.tissue, None]
    wp.launch(solver.elements.measure_bands, (rings - 1, 1), inputs=[0, *inputs], outputs=[solver.bands])
    upper = np.triu(solver.bands.numpy()[..., 0].astype(float))
    of_rings = np.zeros((15, 2 * MODES))  # t of the ring less t of the next one, g_p and g_q of the one, of the other
    of_rings[:9, :9] = np.eye(9)
    of_rings[:3, 9:12] = -np.eye(3)
    of_rings[9:, 12:] = np.eye(6)
    out = np.zeros((rings * MODES, rings * MODES))
    for r in range(rings - 1):
        band = upper[r] + np.triu(upper[r], 1).T
        both = slice(MODES * r, MODES * (r + 2))
        out[both, both] += of_rings.T @ band @ of_rings
    return out


def basis(sim: Simulation) -> np.ndarray:
    """Displacement of every vertex by every unknown, shape (3 V, 9 R)."""
    ring, plane = sim.colon.wall.ring, sim.wall.rings.plane.numpy()[:, 0]
    out = np.zeros((len(ring), 3, sim.wall.ring_count, 3, 3))
    for k, field in enumerate((np.ones(len(ring)), plane[:, 0], plane[:, 1])):
        for c in range(3):
            out[np.arange(len(ring)), c, ring, k, c] = field
    return out.reshape(3 * len(ring), -1)


def elastic_force(sim: Simulation, points: np.ndarray) -> np.ndarray:
    """Force of the elements, shape (3 V,)."""
    x = wp.array(points[:, None].astype(np.float32), dtype=wp.vec3, device="cpu")
    return static_force(sim, x).numpy()[:, 0].astype(float).ravel()


@pytest.mark.parametrize("kind", ["shell", "solid"])
def test_at_rest_it_is_the_small_strain_stiffness(tiny_sim: TinySim, kind: str) -> None:
    sim = make(tiny_sim, kind)
    wall, (mu, lam, _) = sim.colon.wall, sim.colon.moduli(*sim.colon.elasticity())
    points = sim.colon.data.nodal_pos_w[0].double().numpy()
    sim.wall.tissue.moduli.assign([[mu, lam, 0.0]])
    corners = wall.triangles if kind == "shell" else wall.tets
    geometry = shell_geometry(points, corners) if kind == "shell" else None
    parts = stretching_stiffness(points, geometry) if geometry else tet_stiffness(points, corners)
    modes = basis(sim).reshape(len(points), 3, -1)[corners]
    expected = np.einsum("taim,taibj,tbjn->mn", modes, mu * parts[0] + lam * parts[1], modes, optimize=True)
    found = matrix(sim, points)
    assert np.abs(found - expected).max() < 2e-4 * np.abs(expected).max()


@pytest.mark.parametrize("kind", ["shell", "solid"])
def test_moving_a_dented_tube_as_a_whole_strains_nothing(tiny_sim: TinySim, kind: str) -> None:
    sim = make(tiny_sim, kind)
    found = matrix(sim, dented(sim))
    for axis in range(3):
        together = np.zeros((sim.wall.ring_count, MODES))
        together[:, axis] = 1.0
        assert np.abs(found @ together.ravel()).max() < 1e-5 * np.abs(found).max()


@pytest.mark.parametrize("kind", ["shell", "solid"])
def test_the_matrix_turns_with_a_dented_tube(tiny_sim: TinySim, kind: str) -> None:
    sim = make(tiny_sim, kind)
    points = dented(sim)
    turn = np.kron(np.eye(3 * sim.wall.ring_count), TURN)
    here, there = matrix(sim, points), matrix(sim, points @ TURN.T)
    assert np.abs(there - turn @ here @ turn.T).max() < 1e-4 * np.abs(here).max()


@pytest.mark.parametrize("kind", ["shell", "solid"])
def test_a_dented_tube_is_nowhere_stiffer_than_the_matrix(tiny_sim: TinySim, kind: str) -> None:
    """The correction overshoots without bound where the true stiffness is twice the matrix's."""
    sim = make(tiny_sim, kind)
    points, modes = dented(sim), basis(sim)
    moving = np.repeat(sim.wall.rings.moves.numpy()[:, 0] == 1, MODES)
    step, true = 2e-5, np.zeros((moving.sum(), moving.sum()))
    for k, mode in enumerate(modes[:, moving].T):
        move = step * mode.reshape(-1, 3)
        difference = elastic_force(sim, points + move) - elastic_force(sim, points - move)
        true[k] = modes[:, moving].T @ difference / (-2.0 * step)
    found = matrix(sim, points)[np.ix_(moving, moving)]
    found += 1e-4 * np.diag(np.diag(found))
    largest = scipy.linalg.eigh(0.5 * (true + true.T), found, eigvals_only=True)[-1]
    assert 0.8 < largest < 1.15


def test_one_correction_of_a_dented_tube_does_not_overshoot(tiny_sim: TinySim) -> None:
    """What the residual does along the step keeps its sign: the energy still falls where the step ends."""
    sim = make(tiny_sim)
    start, solver = dented(sim), sim.wall
    sim.nodal_pos.assign(start[:, None].astype(np.float32))
    sim.contact.detect(sim.nodal_pos, sim.state.body_q)
    solver.x_prev.assign(sim.nodal_pos)
    solver.inertial.assign(sim.nodal_pos)
    contacts = wall_contacts(sim.contact, sim.cfg.dt, solver.x_prev, sim.state.body_q, sim.state.body_q)
    solver._measure(sim.nodal_pos)
    solver._residual(sim.nodal_pos, solver.inertial, contacts, solver.force)
    force = solver.force.numpy()[:, 0].ravel()
    solver._correct_rings(sim.nodal_pos, sim.nodal_pos, contacts, repeat=0)
    move = (sim.nodal_pos.numpy()[:, 0] - start).ravel()
    before = force @ move
    solver._measure(sim.nodal_pos)
    solver._residual(sim.nodal_pos, solver.inertial, contacts, solver.force)
    after = solver.force.numpy()[:, 0].ravel() @ move
    assert before > 0.0 and -0.1 * before < after < before
    assert torch.isfinite(sim.colon.data.nodal_pos_w).all()
