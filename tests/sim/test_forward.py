# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Worlds that were not written to stay as they are when the others' link poses are recomputed."""

from __future__ import annotations

import torch
import warp as wp


def test_only_the_masked_worlds_are_recomputed(tiny_sim) -> None:
    sim = tiny_sim("magnetic", num_envs=2)
    poses = wp.to_torch(sim.state.body_q)
    before = poses.clone()
    poses += 1.0
    sim.forward(torch.tensor([True, False]))
    links = len(poses) // 2
    torch.testing.assert_close(poses[:links], before[:links])
    assert torch.equal(poses[links:], before[links:] + 1.0)
