# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What the push through a narrow bend owes to the chain that stands for the shaft: link length and hinge damping."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, relative
from arcgym.benchmarks.fidelity.tubes import Tube

if TYPE_CHECKING:
    from arcgym.assets.endoscope_spec import EndoscopeSpec

FRICTION = (0.1, 0.3)
"""Friction coefficients of the worlds."""
BEND_ANGLE, BEND_START, LUMEN = math.radians(100.0), 0.14, 0.010
"""Angle of the bend [rad], arc length at which it starts [m] and radius of the lumen [m]."""
BENDS = {"links_bend": 0.040, "links_tight_bend": 0.015}
"""Radius of the centerline by row [m]. Of the bends of real colons, one in twenty is tighter than 18 to 20 mm."""
BEYOND, LAST = 0.10, 0.15
"""How far beyond the bend the tip is when forces begin to count and when they end [m]."""
SPEED, CONTROL_STEP = 0.05, 0.1
"""Speed of the base [m/s] and time over which forces are averaged [s]."""
SECTION = 0.10
"""Length of the bending section, which is steered along the bend [m]."""
AMPLE = 200.0
"""Limit of the push [N], beyond any that occurs."""


def link_length(run: Run) -> list[Row]:
    """Compare the push through two bends of a rigid tube with that of a shaft of links half as long."""
    from arcgym.assets.endoscope_spec import SHAFT_LINK, proximal_spec

    rows = []
    for name, radius in BENDS.items():
        ours, half = (
            push_through(run, proximal_spec(0.9, link), radius, rigid=True) for link in (SHAFT_LINK, 0.5 * SHAFT_LINK)
        )
        plot = Plot(name, "inserted length [m]", "push on the base [N]")
        for world, friction in enumerate(FRICTION):
            plot.lines.append((f"links half as long, μ = {friction}", half[:, 0], half[:, 1 + world]))
            plot.points.append((f"shipped links, μ = {friction}", ours[:, 0], ours[:, 1 + world]))
        run.plots.append(plot)
        rows.append(worst_friction(name, late(ours, radius), late(half, radius)))
    return rows


def damping(run: Run) -> list[Row]:
    """Compare the push through the wide bend of a soft tube with that of a shaft with a fifth of the hinge damping."""
    from arcgym.assets.endoscope_spec import proximal_spec

    spec, radius = proximal_spec(0.9), BENDS["links_bend"]
    fifth = replace(spec, damping_time=0.2 * spec.damping_time)
    ours, less = (late(push_through(run, scope, radius, rigid=False), radius) for scope in (spec, fifth))
    return [worst_friction("damping_bend", ours, less)]


def push_through(run: Run, spec: EndoscopeSpec, radius: float, rigid: bool) -> np.ndarray:
    """Push a scope through the bend, one world a friction; return inserted length [m] and pushes [N], (S, 1 + W)."""
    import torch

    from arcgym.benchmarks.fidelity.models import build

    assert spec.slide_drive is not None
    spec = replace(spec, slide_drive=replace(spec.slide_drive, max_force=AMPLE))
    end = BEND_START + BEND_ANGLE * radius
    tube = Tube(end + 0.25, BEND_ANGLE, BEND_START, radius, radius=LUMEN)
    sim = build(run, spec, tube, len(FRICTION), {"rigid": rigid})
    scope, steps = sim.endoscope, round(CONTROL_STEP / sim.physics_dt)
    scope.write_friction_to_sim(torch.tensor(FRICTION, device=sim.device))
    still, samples = torch.zeros(len(FRICTION), device=sim.device), []
    scope.set_insertion_command(still + SPEED, still)
    for _ in range(round((end + LAST - scope.rest_insertion) / (SPEED * CONTROL_STEP))):
        inserted = scope.data.inserted_length[0].item()
        turned = np.clip((np.array([inserted, inserted - SECTION]) - BEND_START) / radius, 0.0, BEND_ANGLE)
        scope.set_bending_command(still - float(turned[0] - turned[1]), still)
        sim.step(steps)
        samples.append([scope.data.inserted_length[0].item(), *scope.data.base_force.tolist()])
    return np.array(samples)


def late(samples: np.ndarray, radius: float) -> np.ndarray:
    """Return the mean pushes with the tip beyond the bend [N], shape (W,)."""
    beyond = samples[:, 0] > BEND_START + BEND_ANGLE * radius + BEYOND
    return samples[beyond, 1:].mean(axis=0)


def worst_friction(name: str, value: np.ndarray, reference: np.ndarray) -> Row:
    """Return the row of the friction with the larger error; all errors go into the note."""
    error = value / reference - 1.0
    worst = int(np.argmax(np.abs(error)))
    note = ", ".join(f"{e:+.1%} at μ = {friction}" for e, friction in zip(error, FRICTION, strict=True))
    return relative(name, float(value[worst]), float(reference[worst]), 0.10, "N", note)
