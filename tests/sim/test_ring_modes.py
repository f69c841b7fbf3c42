# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rest stiffness of the wall projected on the modes of its rings."""

from __future__ import annotations

import numpy as np
import pytest
from tiny import tiny_colon_stage

from arcgym.anatomy.shell import ShellMesh, mid_surface
from arcgym.assets.materials import shell_moduli
from arcgym.assets.shell_geometry import shell_geometry
from arcgym.sim.wall.ring_modes import MODES, ElasticPart, RingModes, ring_modes
from arcgym.sim.wall.shell_elements import bending_bound, stretching_stiffness
from arcgym.sim.wall.solid_elements import tet_stiffness

TISSUE = 1.0e6, 4.0e6
"""Shear modulus and second Lamé parameter [Pa]."""


def solid_parts(points: np.ndarray, tets: np.ndarray) -> list[ElasticPart]:
    """Shear and dilation of a solid's tets, and no bending."""
    stiffness = tet_stiffness(points, tets)
    return [*(ElasticPart(tets, value * k) for value, k in zip(TISSUE, stiffness, strict=True)), ElasticPart.none()]


def shell_parts(shell: ShellMesh) -> list[ElasticPart]:
    """Stretching and bending of a shell 2 mm thick."""
    geometry = shell_geometry(shell.points, shell.triangles)
    stretching = stretching_stiffness(shell.points, geometry)
    bending = bending_bound(shell.points, geometry)
    moduli = shell_moduli(1.0e6, 0.4, 0.002)
    return [
        *(ElasticPart(shell.triangles, value * k) for value, k in zip(moduli, stretching, strict=False)),
        ElasticPart(geometry.hinges, moduli[2] * bending),
    ]


def modes_of(kind: str, mobile: np.ndarray | None = None) -> tuple[np.ndarray, RingModes]:
    """Vertex masses and modes of the tiny tube; anchors of 2 N/m at every vertex, nothing held by default."""
    wall = tiny_colon_stage().wall
    shell = mid_surface(wall, 0.002)
    mesh = shell if kind == "shell" else wall
    points, count = mesh.points.astype(float), len(mesh.points)
    parts = shell_parts(shell) if kind == "shell" else solid_parts(points, wall.tets)
    mass = np.linspace(1e-4, 2e-4, count)
    free = np.ones(count, bool) if mobile is None else mobile
    return mass, ring_modes(points, mesh.ring, free, mass, np.full(count, 2.0), parts)


@pytest.fixture(scope="module", params=["shell", "solid"])
def free_tube(request: pytest.FixtureRequest) -> tuple[np.ndarray, RingModes]:
    return modes_of(request.param)


def assembled(modes: RingModes) -> np.ndarray:
    rings = len(modes.mass)
    stiffness, coupling = modes.stiffness.sum(axis=0), modes.coupling.sum(axis=0)
    full = np.zeros((rings, MODES, rings, MODES))
    for r in range(rings):
        full[r, :, r] = stiffness[r]
        if r + 1 < rings:
            full[r, :, r + 1] = coupling[r]
            full[r + 1, :, r] = coupling[r].T
    return full.reshape(rings * MODES, rings * MODES)


def test_stiffness_is_symmetric_and_never_negative(free_tube: tuple) -> None:
    matrix = assembled(free_tube[1])
    values = np.linalg.eigvalsh(matrix)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-9 * np.abs(matrix).max())
    assert values.min() > -1e-9 * values.max()


@pytest.mark.parametrize("axis", range(3))
def test_moving_all_rings_together_costs_nothing(free_tube: tuple, axis: int) -> None:
    matrix = assembled(free_tube[1])
    together = np.zeros((len(matrix) // MODES, MODES))
    together[:, axis] = 1.0
    force = matrix @ together.ravel()
    alone = matrix[:, axis]
    assert np.abs(force).max() < 1e-9 * np.abs(alone).max()


def test_mass_and_anchors_of_the_translations_sum_to_the_walls(free_tube: tuple) -> None:
    mass, modes = free_tube
    for axis in range(3):
        assert modes.mass[:, axis, axis].sum() == pytest.approx(mass.sum())
        assert modes.anchor[:, axis, axis].sum() == pytest.approx(2.0 * len(mass))


def test_held_vertices_take_no_part() -> None:
    _, modes = modes_of("solid", tiny_colon_stage().wall.ring > 2)
    assert not modes.mass[:3].any() and not modes.coupling[:, :3].any()
    np.testing.assert_array_equal(modes.stiffness[:, 0].sum(axis=0), 1.0e3 * np.eye(MODES))


def test_modes_span_every_affine_motion_of_a_ring() -> None:
    _, modes = modes_of("shell")
    shell = mid_surface(tiny_colon_stage().wall, 0.002)
    ring = np.flatnonzero(shell.ring == 8)
    local = shell.points[ring].astype(float) - shell.points[ring].mean(axis=0)
    matrix = np.random.default_rng(0).normal(size=(3, 3)) * [1.0, 1.0, 0.0]  # rings are flat: nothing along Z matters
    wanted = local @ matrix.T + [1.0, 2.0, 3.0]
    basis = modes.basis[ring].transpose(0, 2, 1).reshape(-1, MODES)
    found, *_ = np.linalg.lstsq(basis, wanted.ravel(), rcond=None)
    np.testing.assert_allclose(basis @ found, wanted.ravel(), atol=1e-6)


def test_rest_frames_are_rotations(free_tube: tuple) -> None:
    frames = free_tube[1].rest_frame
    np.testing.assert_allclose(frames @ frames.transpose(0, 2, 1), np.tile(np.eye(3), (len(frames), 1, 1)), atol=1e-6)
    np.testing.assert_allclose(np.abs(frames[:, 2, 2]), 1.0, atol=1e-6)  # the straight tube runs along Z
