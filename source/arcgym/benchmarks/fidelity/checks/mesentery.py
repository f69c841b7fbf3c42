# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A stiff tube that hangs on a sheet by its weight alone."""

from __future__ import annotations

import math

import numpy as np

from arcgym.benchmarks.fidelity.checks.abdomen import free_tube
from arcgym.benchmarks.fidelity.loads import settle
from arcgym.benchmarks.fidelity.rows import Row, Run, relative
from arcgym.benchmarks.fidelity.tubes import SEGMENT

HEIGHT = 0.006
"""Height of the sheet, the same all along [m]: the tube swings clear of what is in it."""


def hang(run: Run) -> list[Row]:
    """Turn a tube that lies in front of its root to the side, and measure how it hangs there.

    It swings by a right angle, until it hangs along its weight w per length; the sheet's strain is
    ln(1 + b w / (E t)) / b.
    """
    from arcgym.assets import MesenteryCfg
    from arcgym.sim import WeightCfg

    weight = WeightCfg(enabled=True, posture="right_lateral", imaged="weightless", contents_per_length=0.0)
    cfg = MesenteryCfg(enabled=True, height={SEGMENT: HEIGHT}, least_height=HEIGHT)
    sim = free_tube(run, {"mesentery": cfg}, weight=weight)
    for spring in (sim.wall.nodes.anchors.stiffness, sim.wall.loads.anchor):
        spring.zero_()  # the hanging springs, which the law of the sheet leaves out
    settle(sim)
    middle = sim.colon.data.nodal_pos_w[0].mean(dim=0).cpu().numpy()
    away = middle - sim.surroundings.mesentery.sheets.root.numpy()[:, 0].mean(axis=0)
    width = float(np.gradient(sim.colon.wall.ring_arc).sum())
    load = weight.acceleration * float(sim.wall.nodes.mass.numpy().sum()) / width
    sheet = cfg.youngs_modulus * cfg.thickness
    strain = math.hypot(away[0], away[1]) / HEIGHT - 1.0
    exact = math.log1p(cfg.stiffening * load / sheet) / cfg.stiffening
    return [
        relative("mesentery_swing", math.atan2(away[0], away[1]), 0.5 * math.pi, 0.02, "rad"),
        relative("mesentery_strain", strain, exact, 0.03),
    ]
