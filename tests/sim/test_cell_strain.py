# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""One strain for the two triangles of a cell, and faces that lie on the surface on average."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import torch
from test_wall_law import BAND, lawful, pull, stretch, uniaxial
from tiny_sim import TinySim

from arcgym.anatomy.meshing.wall import tube_triangles
from arcgym.assets.shell_geometry import shell_geometry
from arcgym.sim import Simulation
from arcgym.sim.wall.cell_strain import cell_partners, partner_edges

RINGS, SECTORS = 4, 6


@pytest.fixture(scope="module")
def tube(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("cells"), sectors=12)


def crooked_tube() -> tuple[np.ndarray, np.ndarray]:
    """Return vertices of a tube whose cells are no rectangles, and its triangles."""
    ring, sector = np.divmod(np.arange(RINGS * SECTORS), SECTORS)
    angle = 2.0 * np.pi * sector / SECTORS + 0.1 * ring
    radius = 1.0 + 0.1 * ((ring + sector) % 3)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), ring + 0.1 * (sector % 2)], axis=1)
    return points, tube_triangles(RINGS, SECTORS)


def squares(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return the squared lengths of the edges opposite to each triangle's corners, shape (F, 3)."""
    corners = points[triangles]
    return ((np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)) ** 2).sum(axis=2)


def test_the_triangles_of_a_cell_are_partners() -> None:
    points, triangles = crooked_tube()
    ring = np.arange(len(points)) // SECTORS
    half = len(triangles) // 2  # the first half has one triangle of every cell, the second the other
    expected = np.r_[np.arange(half) + half, np.arange(half)]
    np.testing.assert_array_equal(cell_partners(shell_geometry(points, triangles), ring), expected)


def test_triangles_of_a_band_that_is_open_have_no_partner() -> None:
    points, triangles = crooked_tube()
    ring = np.arange(len(points)) // SECTORS
    kept = np.arange(1, len(triangles))  # without the first, of the first band
    partner = cell_partners(shell_geometry(points, triangles[kept]), ring)
    first = (ring[triangles[kept]].min(axis=1)) == 0
    assert (partner[first] == np.flatnonzero(first)).all() and (partner[~first] != np.flatnonzero(~first)).all()


def test_edges_in_the_partners_strain_are_exact_where_both_strain_alike() -> None:
    points, triangles = crooked_tube()
    geometry = shell_geometry(points, triangles)
    partner = cell_partners(geometry, np.arange(len(points)) // SECTORS)
    edges = partner_edges(geometry, points, partner)
    np.testing.assert_allclose(
        np.einsum("tab,tb->ta", edges, squares(points, triangles)[partner]), squares(points, triangles)
    )
    flat = np.array([[0.0, 0.0, 0.0], [1.0, 0.2, 0.0], [1.3, 1.1, 0.0], [-0.1, 0.9, 0.0]])
    pair = np.array([[0, 1, 2], [0, 2, 3]])
    sheared = flat @ np.array([[1.2, 0.3, 0.0], [0.0, 0.9, 0.0], [0.0, 0.0, 1.0]])
    edges = partner_edges(shell_geometry(flat, pair), flat, np.array([1, 0]))
    np.testing.assert_allclose(np.einsum("tab,tb->ta", edges, squares(sheared, pair)[::-1]), squares(sheared, pair))


def test_a_uniform_stretch_pulls_as_before(tube: TinySim) -> None:
    sim = lawful(tube, cell_strain=True)
    stretch(sim, 1.3)
    assert pull(sim) == pytest.approx(uniaxial(sim, 1.3, 2.75), rel=1.0e-3)


def dented(sim: Simulation, depth: float) -> float:
    """Push one vertex outwards and return the force that takes, its neighbors at rest after two seconds [N]."""
    wall, moved = sim.colon.wall, sim.colon.data.nodal_pos_w[0]
    vertex = int(np.flatnonzero(wall.ring == BAND)[0])
    outward = torch.tensor([*wall.points[vertex, :2], 0.0])
    outward /= outward.norm()
    place = moved[vertex] + depth * outward
    for _ in range(240):
        moved[vertex] = place
        sim.colon.data.nodal_vel_w[0, vertex] = 0.0
        sim.step(4)
        sim.colon.data.nodal_vel_w *= 0.9
    moved[vertex] = place
    sim.wall.elements.measure(sim.nodal_pos, sim.wall.tissue)
    data = sim.wall.elements.data
    shell = getattr(data, "shell", data)
    forces = shell.corner_force.numpy()[:, 0].reshape(-1, 3, 3)
    force = forces[shell.triangles.numpy() == vertex].sum(axis=0)
    return float(-force @ outward.numpy())


def test_a_coarse_wall_gives_way_more_easily(tube: TinySim) -> None:
    plain, cells = (dented(lawful(tube, **law), 1.0e-3) for law in ({"stiffening": 2.75}, {"cell_strain": True}))
    assert 0.0 < cells < 0.8 * plain


def test_tension_that_fades_is_that_of_the_cell(tube: TinySim) -> None:
    fading = {"relaxation": True, "relaxing_share": (0.4, 0.4), "relaxing_time": (0.01, 0.01)}
    forces = [dented(lawful(tube, cell_strain=True, **law), 1.0e-3) for law in ({}, fading)]
    assert forces[1] < forces[0]


def test_faces_lie_on_the_surface_on_average(tube: TinySim) -> None:
    plain, mean = (lawful(tube, **law).colon.wall for law in ({}, {"mean_surface": True}))
    inner = (plain.ring > 0) & (plain.ring < plain.ring.max() - 1)  # the last ring narrows to the blind end
    radius = [np.hypot(*wall.points[inner, :2].T) for wall in (plain, mean)]
    widened = 1.0 + (1.0 - math.cos(math.pi / 6.0)) / 6.0  # minus a twelfth of 2 r (cos 30 deg - 1)
    np.testing.assert_allclose(radius[1] / radius[0], widened, rtol=1.0e-5)
    area = 6.0 * math.sin(math.pi / 6.0) / math.pi  # of twelve corners, over the circle's
    assert area == pytest.approx(0.955, abs=0.001) and area * widened**2 == pytest.approx(1.0, abs=0.003)
    np.testing.assert_array_equal(mean.triangles, plain.triangles)


def test_the_stage_is_still_the_patients(tube: TinySim, tmp_path: Path) -> None:
    colon = lawful(tube, mean_surface=True).colon
    assert colon.stage.wall is not None and colon.cfg.wall_law.active
