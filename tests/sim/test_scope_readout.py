# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Forces on tip and windows of a scope of six links, two worlds, from forces on the links set by hand.

From the front: links of 16.6 (with the round end), 10, 10 and three times 25 mm, 111.6 mm in all.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch
import warp as wp
from tiny_scope import tiny_scope_spec
from tiny_sim import TinySim

from arcgym.assets.endoscope_stage import write_endoscope
from arcgym.sim import Simulation

LENGTH = np.array([0.025, 0.025, 0.025, 0.010, 0.010, 0.010])
"""Length of the links, base first [m]."""
RADIUS = np.full(6, 0.0066)
"""Their radius [m], by which the round end stands out."""


@pytest.fixture(scope="module")
def sim(tmp_path_factory: pytest.TempPathFactory) -> Simulation:
    tiny = TinySim(tmp_path_factory.mktemp("readout"))
    spec = replace(tiny_scope_spec(), link_length=LENGTH, link_radius=RADIUS)
    write_endoscope(spec, tiny.folder / "proximal_6.usda")
    return tiny(num_envs=2)


def control_step(sim: Simulation, *steps: tuple[int, int, tuple[float, float, float]]) -> None:
    """Make a control step of which each physics step has one force, on (world, link)."""
    readout = sim.scope_readout
    readout.clear()
    for world, link, force in steps:
        wp.to_torch(readout.step_force).view(2, 6, 3)[world, link] = torch.tensor(force)
        readout.collect()
    readout.finish(len(steps))
    sim.forward()


def test_shapes(sim: Simulation) -> None:
    data = sim.endoscope.data
    # Windows begin at 0, 25, 50 and 75 mm.
    assert data.window_force_w.shape == (2, 4, 3)
    assert data.window_force_norm.shape == data.window_force_peak.shape == (2, 4)
    assert data.window_arc.tolist() == pytest.approx([0.025, 0.050, 0.075, 0.5 * (0.075 + 0.1116)])
    assert data.tip_force_w.shape == (2, 3) and data.tip_force.shape == data.tip_force_peak.shape == (2,)


def test_a_force_is_shared_by_the_windows_that_its_link_lies_in(sim: Simulation) -> None:
    # Link 2 lies from 36.6 to 61.6 mm: 13.4 of 25 mm in the window 0-50, all in 25-75, 11.6 mm in 50-100.
    control_step(sim, (1, 2, (0.0, 1.0, 0.0)))
    data = sim.endoscope.data
    expected = torch.tensor([[0.0] * 4, [13.4 / 25.0, 1.0, 11.6 / 25.0, 0.0]])
    torch.testing.assert_close(data.window_force_w[..., 1], expected)
    torch.testing.assert_close(data.window_force_norm, expected)
    assert not data.tip_force.any()


def test_forces_in_a_window_add_up_as_vectors(sim: Simulation) -> None:
    wp.to_torch(sim.scope_readout.step_force).view(2, 6, 3)[0, 5] = torch.tensor([3.0, 0.0, 0.0])
    control_step(sim, (0, 4, (0.0, 4.0, 0.0)))
    # Both distal links lie in the first window; 3.4 of the 10 mm of the second belong to the tip.
    assert sim.endoscope.data.window_force_norm[0, 0].item() == pytest.approx(5.0)
    torch.testing.assert_close(sim.endoscope.data.tip_force_w[0], torch.tensor([3.0, 0.34 * 4.0, 0.0]))


def test_mean_is_that_of_the_vector_and_peak_the_largest_of_a_physics_step(sim: Simulation) -> None:
    control_step(sim, (0, 5, (3.0, 0.0, 0.0)), (0, 5, (-1.0, 0.0, 0.0)))
    data = sim.endoscope.data
    assert (data.tip_force[0].item(), data.tip_force_peak[0].item()) == pytest.approx((1.0, 3.0))
    assert (data.window_force_norm[0, 0].item(), data.window_force_peak[0, 0].item()) == pytest.approx((1.0, 3.0))
    assert (data.window_force_peak >= data.window_force_norm).all()


def test_a_new_control_step_forgets_the_last(sim: Simulation) -> None:
    control_step(sim, (0, 5, (3.0, 0.0, 0.0)))
    control_step(sim, (0, 5, (1.0, 0.0, 0.0)))
    assert sim.endoscope.data.window_force_peak[0, 0].item() == pytest.approx(1.0)


def test_a_reset_zeroes_its_own_world(sim: Simulation) -> None:
    control_step(sim, (0, 5, (3.0, 0.0, 0.0)), (1, 5, (3.0, 0.0, 0.0)))
    sim.write_snapshot(-1, [1])
    data = sim.endoscope.data
    readings = (
        data.window_force_norm,
        data.window_force_peak,
        data.window_force_w,
        data.tip_force,
        data.tip_force_peak,
    )
    for force in readings:
        assert force[0].any() and not force[1].any()
