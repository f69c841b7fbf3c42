# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What the effects of a living colon add to a physics step: few launches, and what the launches apart would do."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest
import torch
import warp as wp
from tiny_sim import TinySim

from arcgym.assets import AbdomenCfg, GasCfg, MesenteryCfg, WallLawCfg
from arcgym.sim import LoopFrictionCfg, Simulation, WeightCfg
from arcgym.sim.wall import wall_kernels, weight_kernels

TISSUE = WallLawCfg(stiffening=1.5, thickness_by_diameter=True, relaxation=True)
LIVING = {
    "material": "clinical",
    "wall_law": TISSUE,
    "gas": GasCfg(enabled=True, pretension=True),
    "abdomen": AbdomenCfg(enabled=True),
    "mesentery": MesenteryCfg(enabled=True),
}


@pytest.fixture(scope="module")
def tube(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("launches"))


def living(tube: TinySim) -> Simulation:
    return tube(links=3, colon=LIVING, weight=WeightCfg(enabled=True), loops=LoopFrictionCfg(enabled=True, bends=True))


def launched(sim: Simulation, monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """Return how often each kernel is launched in a physics step."""
    found, launch = Counter[str](), wp.launch

    def counted(kernel: wp.Kernel, *args: Any, **named: Any) -> Any:
        found[kernel.key] += 1
        return launch(kernel, *args, **named)

    with monkeypatch.context() as patched:
        patched.setattr(wp, "launch", counted)
        sim.step(1)  # the first steps run kernel by kernel
    return found


def test_all_effects_add_ten_launches(tube: TinySim, monkeypatch: pytest.MonkeyPatch) -> None:
    plain, all_of_them = launched(tube(links=3), monkeypatch), launched(living(tube), monkeypatch)
    extra = all_of_them - plain
    assert sum(all_of_them.values()) - sum(plain.values()) == 10
    assert set(extra) == {
        *("measure_held_slices", "assemble_push", "solve_again", "measure_gain", "settle_pressure"),  # gas
        *("measure_surroundings", "add_outer_rows", "move_hand", "read_sheets", "rub_loops"),  # what lies around
        *("relax_and_measure", "predict_weighing", "prolong_with_gas"),  # in the place of plain ones
    }


def test_weight_and_inertia_in_one_launch_are_those_of_two(tube: TinySim) -> None:
    sim = living(tube)
    wall, weight, shape = sim.wall, sim.wall.weight, sim.nodal_pos.shape
    sim.write_gravity(torch.tensor([[0.0, 9.81, 0.0]]))  # on the belly
    rng = np.random.default_rng(0)
    v = wp.array(rng.normal(0.0, 0.3, (*shape, 3)).astype(np.float32), dtype=wp.vec3, device=sim.device)
    inputs = [0, sim.nodal_pos, v, wall.nodes, wall.tissue, 0.9, 0.5, wall.dt]
    one, two = ([wp.zeros(shape, dtype=wp.vec3, device=sim.device) for _ in range(2)] for _ in range(2))
    wp.launch(weight_kernels.predict_weighing, shape, inputs=[*inputs, *weight.inputs], outputs=one, device=sim.device)
    wp.launch(wall_kernels.predict, shape, inputs=inputs, outputs=two, device=sim.device)
    plain = two[1].numpy().copy()
    weight.add(wall.nodes, wall.tissue, wall.dt, two[1])
    np.testing.assert_array_equal(one[0].numpy(), two[0].numpy())
    np.testing.assert_allclose(one[1].numpy(), two[1].numpy(), rtol=0.0, atol=1.0e-8)  # an ulp of 0.2 m
    assert np.abs(two[1].numpy() - plain).max() > 1.0e-5  # 2 g dt^2 is 85 um


def test_fading_and_measuring_in_one_launch_are_those_of_two(tube: TinySim) -> None:
    """The memory follows where a step starts, the forces are those of where it is measured."""
    sims = [living(tube) for _ in range(2)]
    start = sims[0].colon.wall.points[:, None] * np.array([1.1, 1.1, 1.05])
    end = sims[0].colon.wall.points[:, None] * np.array([1.2, 1.1, 1.0])
    at = [wp.array(x.astype(np.float32), dtype=wp.vec3, device=sims[0].device) for x in (start, end)]
    forces, memory = [], []
    for sim, together in zip(sims, (True, False), strict=True):
        elements = sim.wall.elements
        elements.advance(at[0], sim.wall.tissue)
        if not together:
            elements.measure(at[0], sim.wall.tissue)  # lets it fade, and measures at the start
        elements.measure(at[1], sim.wall.tissue)
        forces.append(elements.data.shell.corner_force.numpy())
        memory.append([elements.memory[f"relaxation.{name}"].numpy().copy() for name in ("quick", "slow")])
    np.testing.assert_array_equal(memory[0], memory[1])
    ways = [1.0 - np.exp(-sims[0].wall.dt / time) for time in TISSUE.relaxing_time]
    assert np.abs(memory[0][0]).max() > 0.0
    np.testing.assert_allclose(memory[0][0] / ways[0], memory[0][1] / ways[1], rtol=1.0e-4, atol=1.0e-6)
    np.testing.assert_array_equal(forces[0], forces[1])
