# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a GPU does beside the rest of a physics step gives what is done in order."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import warp as wp
from tiny_sim import TinySim

from arcgym.utils.side_stream import SideStream

CUDA = pytest.mark.skipif(not wp.is_cuda_available(), reason="needs CUDA")


def test_on_a_cpu_work_is_done_where_it_is_launched() -> None:
    numbers = wp.zeros(3, dtype=float, device="cpu")
    side = SideStream("cpu")
    with side.scope():
        numbers.fill_(2.0)
    side.join()
    assert not side.on_gpu
    assert numbers.numpy().tolist() == [2.0, 2.0, 2.0]


@CUDA
def test_on_a_gpu_what_follows_waits() -> None:
    numbers, copies = (wp.zeros(1 << 24, dtype=float, device="cuda:0") for _ in range(2))
    side = SideStream("cuda:0")
    with side.scope():
        numbers.fill_(2.0)
    side.join()
    wp.copy(copies, numbers)
    assert copies.numpy().min() == 2.0


def test_a_wall_that_was_begun_ends_as_one_that_begins_itself(tiny_sim: TinySim) -> None:
    ends = []
    for begun in (False, True):
        sim = tiny_sim("proximal", num_envs=2, use_graph=False)
        wp.to_torch(sim.nodal_pos)[..., 0] += torch.tensor([0.014, 0.015])
        sim.forward()
        for _ in range(4):
            coupling = sim.coupling
            coupling.move_scope()
            if begun:
                sim.wall.begin_contacts(sim.nodal_pos, sim.contact, coupling.body_q_prev)
            sim.wall.step(sim.nodal_pos, sim.nodal_vel, sim.contact, sim.state.body_q, coupling.body_q_prev)
            coupling.finish_contacts()
        assert sim.contact.records.start.numpy()[:, -1].min() > 2
        ends.append([sim.nodal_pos.numpy(), sim.contact.debt.numpy(), sim.state.joint_q.numpy()])
    for one, other in zip(*ends, strict=True):
        np.testing.assert_array_equal(one, other)
