# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A GPU, which has kernels of its own for some of the work, steps as a CPU does."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from tiny_sim import TinySim

CUDA = pytest.mark.skipif(not wp.is_cuda_available(), reason="needs CUDA")


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
