# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A wall that stands still is measured where states are written, not in every step, and is felt as it was."""

from __future__ import annotations

import torch
import warp as wp
from tiny_sim import TinySim


def test_forces_are_those_of_a_wall_measured_in_every_step(tiny_sim: TinySim) -> None:
    ends = []
    for still in (True, False):
        sim = tiny_sim("capsule", colon={"rigid": True})
        assert sim.contact.still
        sim.contact.still = still
        wp.to_torch(sim.nodal_pos)[..., 0] += 0.015  # of a tube of 20 mm radius around the capsule
        sim.forward()
        sim.step(40)
        assert sim.contact.records.start.numpy()[0, -1] > 0
        ends.append({name: array.clone() for name, array in sim.world_arrays().items()})
    for name, array in ends[0].items():
        assert torch.equal(array, ends[1][name]), name


def test_a_wall_is_felt_where_it_was_put(tiny_sim: TinySim) -> None:
    sim = tiny_sim("capsule", colon={"rigid": True})
    sim.step(2)
    assert sim.contact.records.start.numpy()[0, -1] == 0
    version, rest = sim.colon.wall_version, wp.to_torch(sim.nodal_pos).clone()
    wp.to_torch(sim.nodal_pos)[..., 0] += 0.015
    sim.forward()
    assert sim.colon.wall_version != version
    moved = wp.to_torch(sim.contact.centers)[..., 0] - 0.015
    sim.step(1)
    assert sim.contact.records.start.numpy()[0, -1] > 0
    wp.to_torch(sim.nodal_pos).copy_(rest)
    sim.forward()
    torch.testing.assert_close(wp.to_torch(sim.contact.centers)[..., 0], moved, atol=1e-6, rtol=0.0)


def test_walls_that_move_have_no_version(tiny_sim: TinySim) -> None:
    assert tiny_sim("capsule").colon.wall_version is None
