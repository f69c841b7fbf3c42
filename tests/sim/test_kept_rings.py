# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a GPU keeps of a wall that hardly moves, here on a CPU."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import warp as wp
from tiny_sim import TinySim

from arcgym.sim import Simulation
from arcgym.sim.contact import carried_kernels, lumen_kernels
from arcgym.sim.contact.contact_search import SPHERE_SLACK
from arcgym.sim.wall.kept_rings import UNMOVED, KeptRings


@pytest.fixture(scope="module")
def sim(tiny_sim: TinySim) -> Simulation:
    """Two worlds."""
    return tiny_sim("proximal", num_envs=2, use_graph=False)


def moved_ring(sim: Simulation, ring: int, world: int, distance: float) -> None:
    """Move a vertex of a ring, away from the axis."""
    vertex = int(np.flatnonzero(sim.wall.rings.ring.numpy() == ring)[0])
    wp.to_torch(sim.nodal_pos)[vertex, world, 0] += distance


def place(sim: Simulation, kept: KeptRings) -> np.ndarray:
    """Look for rings that moved; which have, shape (R, W)."""
    wall = sim.wall
    kept.place(sim.nodal_pos, wall.rings, wall.loads, wall.axes, wall.shift, wall.tissue)
    return kept.rings.changed.numpy().copy()


def test_rings_change_when_a_vertex_tissue_or_state_does(sim: Simulation) -> None:
    wall = sim.wall
    kept = KeptRings(wall.vertex_count, wall.ring_count, 2, sim.device)
    assert place(sim, kept).all()
    assert not place(sim, kept).any()
    moved_ring(sim, 5, 1, 0.6 * UNMOVED)
    assert not place(sim, kept).any()
    moved_ring(sim, 5, 1, 0.6 * UNMOVED)  # from where it was measured, not since the last step
    assert np.argwhere(place(sim, kept)).tolist() == [[5, 1]]
    assert not place(sim, kept).any()
    wp.to_torch(wall.tissue.moduli)[0, 0] *= 1.01
    changed = place(sim, kept)
    assert changed[:, 0].all() and not changed[:, 1].any()
    wp.to_torch(wall.tissue.anchor)[1] *= 1.01
    changed = place(sim, kept)
    assert changed[:, 1].all() and not changed[:, 0].any()
    kept.forget(wp.array([False, True, False], dtype=bool, device=sim.device))
    changed = place(sim, kept)
    assert changed[:, 1].all() and not changed[:, 0].any()


def test_stiffness_is_measured_where_a_ring_changed(sim: Simulation) -> None:
    wall = sim.wall
    kept = KeptRings(wall.vertex_count, wall.ring_count, 2, sim.device)
    place(sim, kept)
    inputs = [0, sim.nodal_pos, wall.elements.data, wall.rings, wall.axes, wall.tissue, kept.rings.changed]
    shape = (wall.ring_count - 1, 2)
    wp.launch(wall.elements.measure_changed_bands, shape, inputs=inputs, outputs=[wall.bands], device=sim.device)
    before = wall.bands.numpy().copy()
    moved_ring(sim, 6, 0, 1.0e-3)
    place(sim, kept)
    wp.launch(wall.elements.measure_changed_bands, shape, inputs=inputs, outputs=[wall.bands], device=sim.device)
    now = wall.bands.numpy().copy()
    wp.launch(wall.elements.measure_bands, shape, inputs=inputs, outputs=[wall.bands], device=sim.device)
    differ = (now != before).any(axis=(1, 2))
    assert np.argwhere(differ).tolist() == [[5, 0], [6, 0]]
    np.testing.assert_array_equal(now, wall.bands.numpy())


def test_rows_are_kept_behind_the_last_change(sim: Simulation) -> None:
    wall = sim.wall
    records = sim.contact.records
    kept = KeptRings(wall.vertex_count, wall.ring_count, 2, sim.device)
    records.ring_head.fill_(-1)
    wall.self_contact.force.in_contact.zero_()

    def first() -> list[int]:
        kept.find_rows(records, wall.self_contact.force)
        return list(kept.rows.first.numpy().tolist())

    rings = wall.ring_count
    assert first() == [rings, rings]
    kept.rings.changed.zero_()
    assert first() == [0, 0]
    wp.to_torch(kept.rings.changed)[4, 0] = 1  # the bands on either side are part of the rows beside it
    assert first() == [6, 0]
    kept.rings.changed.zero_()
    wp.to_torch(records.ring_head)[3, 1] = 7  # a contact between rings 3 and 4
    assert first() == [0, 5]
    records.ring_head.fill_(-1)
    assert first() == [0, 5], "the contact has left the rows"
    assert first() == [0, 0]
    wp.to_torch(wall.self_contact.force.in_contact)[8, 0] = 1
    assert first() == [9, 0]
    wall.self_contact.force.in_contact.zero_()
    kept.forget_rows()
    assert first() == [rings, rings]


def launch(kernel: wp.Kernel, sim: Simulation, inputs: list[object]) -> None:
    wp.launch(kernel, (sim.contact.ring_count, 2), inputs=inputs, device=sim.device)


def test_spheres_hold_the_faces_of_a_wall_that_moves(sim: Simulation) -> None:
    contact, generator = sim.contact, torch.Generator().manual_seed(3)
    surface, x = contact.surface, wp.to_torch(sim.nodal_pos)
    place = wp.full(sim.nodal_pos.shape, lumen_kernels.FAR, dtype=wp.vec3, device=sim.device)
    moved = wp.zeros((contact.ring_count, 2), dtype=int, device=sim.device)
    vertices = surface.patch_vertices.numpy()
    kept = 0
    for step in range(12):
        x += 4.0e-5 * (torch.rand(x.shape, generator=generator) - 0.3)
        launch(lumen_kernels.follow_rings, sim, [sim.nodal_pos, surface, SPHERE_SLACK, contact.centers, place, moved])
        inputs = [sim.nodal_pos, surface, moved, SPHERE_SLACK, contact.bounds]
        launch(lumen_kernels.bound_moved_faces, sim, inputs)
        assert step > 0 or moved.numpy().all()
        kept += int((moved.numpy() == 0).sum())
        spheres = contact.bounds.patch.numpy()
        away = np.linalg.norm(sim.nodal_pos.numpy()[vertices] - spheres[:, None, :, :3], axis=-1)
        assert (away <= spheres[:, None, :, 3] + 1e-7).all()
        centers = sim.nodal_pos.numpy()[surface.rings.numpy()].mean(axis=1).swapaxes(0, 1)
        np.testing.assert_allclose(contact.centers.numpy(), centers, atol=1e-6)
    assert kept > 40


def test_a_fine_surface_is_near_links_as_ever(sim: Simulation) -> None:
    """With spheres that are kept, the same rings count as near, or more."""
    contact, room = sim.contact, wp.zeros((sim.contact.ring_count, 1), dtype=float, device=sim.device)
    patient = wp.zeros(2, dtype=int, device=sim.device)
    near, ever = (wp.zeros((contact.ring_count, 2), dtype=int, device=sim.device) for _ in range(2))
    moved, spheres = wp.ones_like(near), wp.zeros(near.shape, dtype=wp.vec4, device=sim.device)
    of_links = [sim.state.body_q, contact.links, contact.law, contact.ring_distance, contact.centers]
    inputs = [sim.nodal_pos, contact.surface, room, patient, *of_links]
    for _ in range(2):
        launch(carried_kernels.mark_near_rings, sim, [*inputs, near])
        launch(carried_kernels.mark_near_followed, sim, [*inputs, moved, SPHERE_SLACK, spheres, ever])
        assert near.numpy().any() and (ever.numpy() >= near.numpy()).all()
        moved.zero_()
        wp.to_torch(sim.nodal_pos)[...] += 2.0e-5
