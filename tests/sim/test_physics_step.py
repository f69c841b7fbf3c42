# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Two cores of a CPU make the physics step that one makes, to the bit."""

from __future__ import annotations

import pytest
import torch
import warp as wp
from tiny_sim import TinySim

from arcgym.utils.cpu_threads import VARIABLE
from arcgym.utils.threaded_graph import ThreadedGraph


@pytest.mark.parametrize("kind", ["capsule", "proximal"])
def test_several_threads_make_the_same_steps_as_one(
    tiny_sim: TinySim, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    ends = []
    for threads in ("1", "2", "3"):
        monkeypatch.setenv(VARIABLE, threads)
        sim = tiny_sim(kind, num_envs=2)
        wp.to_torch(sim.nodal_pos)[..., 0] += 0.014  # of a tube of 20 mm radius around the scope
        sim.forward()
        sim.step(30)
        assert isinstance(sim._physics.recorded, ThreadedGraph) == (threads != "1")
        assert sim.contact.records.start.numpy()[:, -1].min() > 0
        ends.append({name: array.clone() for name, array in sim.world_arrays().items()})
    for name, array in ends[0].items():
        assert all(torch.equal(array, end[name]) for end in ends[1:]), name


def test_a_wall_that_stands_still_needs_one_thread(tiny_sim: TinySim, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "2")
    sim = tiny_sim("capsule", colon={"rigid": True})
    sim.step(3)
    assert isinstance(sim._physics.recorded, wp.Graph)
