# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Friction around a bend: pull on a rope, and tension along a tether."""

from __future__ import annotations

import math

import numpy as np

from arcgym.benchmarks.fidelity.beams import capstan_ratio
from arcgym.benchmarks.fidelity.rope import ANGLES, FRICTION, LOOP, PULL, pull_rope, rope, surface_lever, tension_along
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, absolute, relative


def capstan(run: Run) -> list[Row]:
    """Pull a limp shaft around a bend; the pull over that without friction is e^(mu theta)."""
    sim, loads = rope(run)
    tension, angle = pull_rope(sim, loads)
    gain = np.log(tension / tension[0])
    k = FRICTION.index(sim.cfg.contact.friction)
    plot = Plot("capstan", "friction coefficient × angle of the bend", "tension / tension without friction")
    product = np.array(FRICTION) * angle
    plot.lines.append(("exp(μθ)", product, np.exp(product)))
    plot.points.append(("shipped settings", product, tension / tension[0]))
    run.plots.append(plot)
    exact = capstan_ratio(FRICTION[k], float(angle[k]))
    lever = surface_lever(sim)
    note = f"exponent {gain[k] / math.log(exact) - 1.0:+.1%}, with the lever of the shaft's surface, {lever:.3f}, "
    note += f"{gain[k] / (lever * math.log(exact)) - 1.0:+.1%}; without friction {tension[0] / PULL - 1.0:+.1%}"
    return [relative("capstan", float(tension[k] / tension[0]), exact, 0.10, "", note)]


def bend_loss(run: Run) -> list[Row]:
    """Measure the share of ln T along a tether around the bend that a line over the angle explains.

    The published shape of the loss is exponential in contact angle times friction (Huan et al. 2020, of the tether of a
    magnetic colonoscope), a straight line of ln T over the angle.
    """
    gain = np.log(tension_along(run))
    gain -= gain[FRICTION.index(0.0)]
    plot = Plot("bend_loss", "contact angle × friction coefficient", "tension / tension without friction")
    shapes, rates = {}, {}
    for friction, y in zip(FRICTION, gain, strict=True):
        if friction > 0.0:
            slope, level = np.polyfit(ANGLES, y, 1)
            rates[friction] = slope / friction
            shapes[friction] = 1.0 - float(np.var(y - slope * ANGLES - level) / np.var(y))
            plot.points.append((f"μ = {friction:g}", friction * ANGLES, np.exp(y)))
    reach = np.linspace(0.0, max(FRICTION) * LOOP.bend, 50)
    plot.lines.append(("exp(μθ)", reach, np.exp(reach)))
    run.plots.append(plot)
    note = "growth over μ: " + ", ".join(f"{rate:.2f} at {friction:g}" for friction, rate in rates.items())
    return [absolute("bend_loss", shapes[0.1], 1.0, 0.01, "", note)]
