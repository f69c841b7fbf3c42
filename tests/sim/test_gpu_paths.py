# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Kernels that a GPU has for what others do on a CPU: both do the same, here on one device."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import warp as wp
from tiny_sim import TinySim

from arcgym.sim import Simulation
from arcgym.sim.contact import contact_list_kernels
from arcgym.sim.contact.patch_list_kernels import find_patches
from arcgym.sim.wall import shell_kernels, shell_measure_cuda_kernels
from arcgym.sim.wall.packed_contact_kernels import FOURS
from arcgym.sim.wall.shell_fans import ordered_corners
from arcgym.sim.wall.wall_topology import vertex_entries

CUDA = pytest.mark.skipif(not wp.is_cuda_available(), reason="needs CUDA")


@pytest.fixture(scope="module")
def touching(tiny_sim: TinySim) -> Simulation:
    """Two worlds, a shaft of six links in each, whose tubes of 20 mm radius lie 14 and 15 mm off its axis."""
    sim = tiny_sim("proximal", num_envs=2, use_graph=False)
    wp.to_torch(sim.nodal_pos)[..., 0] += torch.tensor([0.014, 0.015])
    sim.forward()
    sim.coupling.find_contacts()
    assert sim.contact.records.start.numpy()[:, -1].min() > 9
    return sim


def lists(sim: Simulation) -> list[list[int]]:
    """Entries of the lists by vertex and by ring, one after the other, of each list of each world."""
    records = sim.contact.records
    found = []
    for head, after in ((records.vertex_head, records.vertex_next), (records.ring_head, records.ring_next)):
        following = after.numpy()
        for at in head.numpy().ravel():
            found.append([])
            while at >= 0:
                found[-1].append(int(at))
                at = following[at]
    return found


def test_lists_are_ordered_side_by_side(touching: Simulation) -> None:
    records, device = touching.contact.records, touching.device
    expected = lists(touching)
    records.ring_head.fill_(-1)
    head, after = records.vertex_head.numpy(), records.vertex_next.numpy()
    for vertex, world in np.argwhere(head >= 0):  # turn each list round
        entries = []
        at = head[vertex, world]
        while at >= 0:
            entries.append(at)
            at = after[at]
        after[entries] = [-1, *entries[:-1]]
        head[vertex, world] = entries[-1]
    scratch = [wp.zeros_like(records.vertex_next), wp.zeros_like(records.ring_next)]
    wp.launch(contact_list_kernels.order_lists, (2, 1), inputs=[records], outputs=scratch, device=device)
    assert max(map(len, expected)) > 2
    assert lists(touching) == expected


def test_patches_are_found_side_by_side(touching: Simulation) -> None:
    contact, device = touching.contact, touching.device
    found = contact.candidates
    names = ("rings", "patches", "start", "link", "patch")
    expected = [getattr(found, name).numpy().copy() for name in names]
    for name in names:
        getattr(found, name).fill_(-7)
    bounds = contact.bounds
    bounds.ring_of_world, bounds.patch_of_world = (
        wp.array(one.numpy().swapaxes(0, 1).copy(), dtype=wp.vec4, device=device) for one in (bounds.ring, bounds.patch)
    )
    inputs = [touching.state.body_q, contact.links, contact.surface, bounds, contact.law]
    inputs += [contact.ring, contact.ring_distance, 1, 1]
    wp.launch(find_patches, (2, 1), inputs=inputs, outputs=[found, contact.records.dropped], device=device)
    pairs = expected[2][:, -1]
    assert pairs.min() > 10
    for name, before in zip(names, expected, strict=True):
        now = getattr(found, name).numpy()
        if name in ("link", "patch"):
            for world, count in enumerate(pairs):
                np.testing.assert_array_equal(now[world, :count], before[world, :count])
        else:
            np.testing.assert_array_equal(now, before)


def test_triangles_around_a_vertex_follow_one_another() -> None:
    """A square of four triangles around vertex 4, and the border around it, whose fans are open."""
    triangles = np.array([[0, 1, 4], [2, 3, 4], [1, 2, 4], [3, 0, 4]])
    start, corner = vertex_entries(triangles, 5)
    ordered = ordered_corners(triangles, start, corner)
    assert ordered[start[4] :].tolist() == [2, 8, 5, 11]  # third corners of triangles 0, 2, 1, 3
    assert ordered[: start[1]].tolist() == [0, 10]  # triangle 0 leads to 4, from where triangle 3 goes on
    assert sorted(ordered) == sorted(corner)


def test_packed_contacts_push_as_records_do(tiny_sim: TinySim) -> None:
    """Twelve steps, in half of which friction holds: in single precision packed contacts round elsewhere."""
    ends = []
    for packed in (False, True):
        sim = tiny_sim("proximal", num_envs=2, use_graph=False)
        wall, slots = sim.wall, len(sim.contact.records.link)
        wall.on_gpu = packed
        wall.packed = wp.zeros(FOURS * slots, dtype=wp.vec4, device=sim.device)
        wp.to_torch(sim.nodal_pos)[..., 0] += torch.tensor([0.014, 0.015])
        sim.forward()
        sim.step(12)
        assert (wall.packed.numpy().any()) == packed
        ends.append([sim.nodal_pos.numpy(), sim.state.joint_q.numpy(), sim.contact.records.slide.numpy()])
    assert np.abs(ends[0][2]).max() > 1e-5
    for one, other, bound in zip(*ends, (5e-6, 1e-4, 5e-6), strict=True):
        np.testing.assert_allclose(other, one, rtol=0.0, atol=bound)


def test_a_shell_is_measured_as_ever(tiny_sim: TinySim) -> None:
    """In single precision the angles of hinges, of which many are small differences, round to 1e-6 rad."""
    sim = tiny_sim("proximal", num_envs=2, use_graph=False)
    shell, generator = sim.wall.elements, torch.Generator().manual_seed(5)
    x = wp.to_torch(sim.nodal_pos)
    x += 1.0e-3 * (torch.rand(x.shape, generator=generator) - 0.5)
    found = []
    for kernels, in_lanes in ((shell_kernels, False), (shell_measure_cuda_kernels, False), (shell_kernels, True)):
        shell.kernels, shell.in_lanes = kernels, in_lanes
        shell.measure(sim.nodal_pos, sim.wall.tissue)
        names = ("angle_change", "moment", "scaled_normal", "corner_force")
        found.append([getattr(shell.data, name).numpy().copy() for name in names])
        for array in (getattr(shell.data, name) for name in names):
            array.fill_(7.0)
    for one, other, lanes in zip(*found, strict=True):
        for that in (other, lanes):
            np.testing.assert_allclose(that, one, rtol=0.0, atol=1.0e-5 * np.abs(one).max())


@CUDA
@pytest.mark.parametrize("kind", ["capsule", "magnetic", "proximal"])
def test_a_gpu_steps_as_a_cpu_does(tiny_sim: TinySim, kind: str) -> None:
    """Twelve steps with the wall 14 mm off the scope's axis.

    On a CPU, walls put 1 um elsewhere end within 3 um, and joints within 7e-5: rounding, a tenth of that, does less.
    """
    ends = []
    for device in ("cpu", "cuda:0"):
        sim = tiny_sim(kind, num_envs=2, device=device)
        wp.to_torch(sim.nodal_pos)[..., 0] += 0.014
        sim.forward()
        sim.step(12)
        ends.append([sim.nodal_pos.numpy(), sim.state.joint_q.numpy()])
    for on_cpu, on_gpu, bound in zip(*ends, (5e-6, 1e-4), strict=True):
        np.testing.assert_allclose(on_gpu, on_cpu, rtol=0.0, atol=bound)
