# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Sag of scope and wall under their own weight against beam theory and bricks."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch

from arcgym.benchmarks.fidelity import beams
from arcgym.benchmarks.fidelity.checks.shaft import worst_plane
from arcgym.benchmarks.fidelity.checks.wall import BEAM_MESH, free_span, reference_tube
from arcgym.benchmarks.fidelity.loads import settle
from arcgym.benchmarks.fidelity.models import build
from arcgym.benchmarks.fidelity.rows import Row, Run, relative
from arcgym.benchmarks.fidelity.shaft import beam, end_places, rigidity, shaft_in_air
from arcgym.benchmarks.fidelity.tubes import FREE, Tube

SHAFT_LINKS = 13
"""Links of the shaft, the first of which is its rigid base: 0.15 m then sag by 5 mm, little enough for a straight
beam's theory."""
LIGHT = 0.5
"""Acceleration at which the tube is weighed [m/s^2]: it then sags by less than a tenth of its thickness."""


def scope_sag(run: Run) -> list[Row]:
    """Measure a clamped length of shaft under its own weight, lying on the side and on the belly."""
    from arcgym.sim import WeightCfg

    weight = WeightCfg(enabled=True)
    sim, _ = shaft_in_air(run, 2, SHAFT_LINKS, {"weight": weight})
    sim.write_gravity(torch.tensor([weight.gravity("right_lateral"), weight.gravity("prone")]))
    settle(sim)
    length, offset = beam(sim)
    load = weight.acceleration * float(sim.model.body_mass.numpy()[1:SHAFT_LINKS].sum()) / length
    end = end_places(sim, offset)
    sag = [float(end[0, 0]), float(end[1, 1])]
    exact = beams.own_weight_deflection(load, length, rigidity(sim))
    return [worst_plane("weight_scope", sag, [exact, exact], [0, 1], 0.02, "m")]


def wall_sag(run: Run) -> list[Row]:
    """Measure a tube held at its ends under its own weight: the mean sag of its span."""
    from arcgym.assets import CAPSULE_CFG
    from arcgym.sim import WeightCfg

    weight = WeightCfg(
        enabled=True, posture="right_lateral", imaged="weightless", acceleration=LIGHT, contents_per_length=0.0
    )
    sim = build(run, CAPSULE_CFG, Tube(0.45), colon={"anchor_stiffness": FREE}, weight=weight)
    rest = sim.colon.data.nodal_pos_w[0].clone()
    settle(sim, tolerance=1.0e-7)
    moved = (sim.colon.data.nodal_pos_w[0] - rest)[:, 0].cpu().numpy()
    start, end = free_span(sim)
    model = reference_tube(sim, **BEAM_MESH)
    middle = model.radius + 0.5 * model.thickness
    mass = sim.colon._value("density") * 2.0 * math.pi * middle * model.thickness * (end - start)
    mean = float((sim.wall.nodes.mass.numpy()[:, 0] * moved).sum()) / mass
    exact = LIGHT * mass * model.compliance(lambda angle, z: np.stack([1.0 + 0.0 * z, 0.0 * z, 0.0 * z], axis=1))
    note = f"a beam's {beam_sag(model, LIGHT * mass):.4g} m"
    return [relative("weight_wall", mean, exact, 0.10, "m", note)]


def beam_sag(model: Any, weight: float) -> float:
    """Return the mean sag of a tube as a beam clamped at both ends, by bending and shear [m].

    W L^3 / 720 EI + W L / 12 k G A, with A = 2 pi R t, I = A R^2 / 2 and k = 1/2 (Timoshenko; Cowper 1966 has
    0.53 for a thin tube).

    Args:
        model: Measures of the tube.
        weight: Its weight W [N].
    """
    radius = model.radius + 0.5 * model.thickness
    area = 2.0 * math.pi * radius * model.thickness
    shear = model.youngs_modulus / (2.0 * (1.0 + model.poissons_ratio)) * area / 2.0
    bending = model.youngs_modulus * area * radius**2 / 2.0
    return float(weight * model.length**3 / (720.0 * bending) + weight * model.length / (12.0 * shear))
