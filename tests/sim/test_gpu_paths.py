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
