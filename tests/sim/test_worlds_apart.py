# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Three worlds of different tissue, friction and motion, in reversed order on the CPU and on a GPU, plainly and with
gas, weight in another posture each, a wall law, a graded shaft, wheels with play, a hand on the abdomen, and sheets."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import torch
import warp as wp
from tiny_sim import TinySim, steps

from arcgym.assets import AbdomenCfg, GasCfg, GradingCfg, MesenteryCfg, WallLawCfg
from arcgym.sim import LoopFrictionCfg, Simulation, WeightCfg

DEVICES = ["cpu", pytest.param("cuda:0", marks=pytest.mark.skipif(not wp.is_cuda_available(), reason="needs CUDA"))]
STEPS = 10


def three(tiny: TinySim, effects: bool, **cfg: Any) -> Simulation:
    """Make three worlds, with all effects that are off by default or with none."""
    if not effects:
        return tiny(links=10, num_envs=3, colon={"youngs_modulus": 5.0e5}, **cfg)
    law = WallLawCfg(stiffening=1.5, thickness_by_diameter=True, relaxation=True, relaxing_time=(0.1, 1.0))
    scope = {"grading": GradingCfg(passive_length=0.05), "drives": {"bending": {"play": 0.1, "lag": 0.05}}}
    colon = {"youngs_modulus": 5.0e5, "gas": GasCfg(enabled=True), "wall_law": law}
    colon["mesentery"] = MesenteryCfg(enabled=True, height={"sigmoid": 0.03})
    colon["abdomen"] = AbdomenCfg(enabled=True, gap=0.0, hand_place=(0.0, 0.0))
    return tiny(
        links=10,
        num_envs=3,
        colon=colon,
        scope=scope,
        weight=WeightCfg(enabled=True),
        loops=LoopFrictionCfg(enabled=True, bends=True),
        **cfg,
    )


def pushed(tiny: TinySim, effects: bool) -> Simulation:
    """Push three bent scopes into walls of 0.7 to 1.4 times the stiffness, until they have moved them."""
    sim = three(tiny, effects)
    if effects:
        down = ("prone", "left_lateral", "right_lateral")
        sim.write_gravity(torch.tensor([sim.cfg.weight.gravity(name) for name in down]))
    sim.moduli.mul_(torch.tensor([[0.7], [1.0], [1.4]]))
    sim.friction.copy_(torch.tensor([0.05, 0.1, 0.15]))
    command(sim, [0, 1, 2])
    for _ in range(10):
        sim.step(steps(sim, 0.1))
    return sim


def command(sim: Simulation, order: list[int]) -> None:
    """Advance and bend each world's scope in a way of its own."""
    advance, bend, aside = ([0.1, 0.09, 0.08], [1.2, 1.1, 1.0], [0.2, 0.0, -0.2])
    values = [torch.tensor(one, device=sim.device)[order] for one in (advance, bend, aside)]
    sim.endoscope.set_insertion_command(values[0], torch.zeros_like(values[0]))
    sim.endoscope.set_bending_command(values[1], values[2])
    if sim.surroundings is not None:
        sim.colon.set_hand_pressure(torch.tensor([20.0, 30.0, 40.0])[order])


@pytest.mark.parametrize("effects", [False, True])
@pytest.mark.parametrize("device", DEVICES)
def test_a_world_goes_on_alike_in_another_place_and_on_a_gpu(tmp_path: Path, device: str, effects: bool) -> None:
    tiny = TinySim(tmp_path, radius=0.016)
    first = pushed(tiny, effects)
    second = three(tiny, effects, device=device)
    for kind in ("world_arrays", "world_settings"):
        for name, array in getattr(second, kind)().items():
            array.copy_(getattr(first, kind)()[name].flip(0))
    command(second, [2, 1, 0])
    start = first.colon.data.nodal_pos_w.clone()
    for sim in (first, second):
        sim.forward()
        sim.step(STEPS)
    here, there = first.colon.data.nodal_pos_w, second.colon.data.nodal_pos_w.cpu().flip(0)
    assert first.colon.data.nodal_displacement.flatten(1).max(dim=1).values.min() > 1.0e-4  # walls are pushed
    assert (here[0] - here[2]).abs().max() > 1.0e-4  # the worlds differ
    assert (here - start).abs().max() > 1.0e-6  # and still move
    torch.testing.assert_close(there, here, rtol=0.0, atol=0.0 if device == "cpu" else 1.0e-5)
