# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What happens when nothing is commanded: energy of a free shaft, drift of a parked one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from arcgym.assets.endoscope_spec import proximal_spec
from arcgym.benchmarks.fidelity.loads import settle
from arcgym.benchmarks.fidelity.pushes import BEND, CONTROL_STEP, DEPTH, push
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, absolute, relative
from arcgym.benchmarks.fidelity.shaft import LINKS, beam, rigidity, shaft_in_air

FAINT = 1.0e-4
"""Hinge damping left, as a share of the shipped; the armature stays as it is."""
PLUCK = 0.02
"""Load from which the shaft is let go [N]."""
SETTLED = 0.25
"""Time after which a shaft let go swings in its first mode alone [s]."""
FIRST_MODE = 1.8751
"""First root k L of the equation of a cantilever's modes, cos(k L) cosh(k L) = -1."""


def loose_shaft(run: Run, damping: float = 1.0) -> tuple[Any, Any]:
    """Return a straight shaft in free air with a share of its hinge damping, its drives without any, and its loads."""
    spec = proximal_spec()
    assert spec.slide_drive is not None and spec.roll_drive is not None
    changes: dict[str, Any] = {
        "damping_time": spec.damping_time * damping,
        "armature_time": spec.armature_time / damping,
        "slide_drive": replace(spec.slide_drive, damping=0.0),
        "roll_drive": replace(spec.roll_drive, damping=0.0),
    }
    return shaft_in_air(run, 1, **changes)


def energies(sim: Any, duration: float) -> tuple[list[float], list[float]]:
    """Return times [s] and energies [J] while the shaft swings."""
    times, values = [0.0], [total_energy(sim)]
    for _ in range(round(duration / (8 * sim.physics_dt))):
        sim.step(8)
        times.append(times[-1] + 8 * sim.physics_dt)
        values.append(total_energy(sim))
    return times, values


def energy(run: Run) -> list[Row]:
    """Measure the largest energy of a bent shaft let go, without damping, over what it started with."""
    sim, _ = loose_shaft(run, FAINT)
    hinges = np.arange(1, LINKS)
    bent = 0.05 * np.cos(np.pi * hinges / LINKS)[:, None] * [1.0, 0.6]
    joint_pos = sim.endoscope.data.joint_pos
    joint_pos[0, sim.endoscope.stage.bend_coords] = joint_pos.new_tensor(bent)
    sim.forward()
    times, values = energies(sim, 2.0)
    relative = np.array(values) / values[0]
    run.plots.append(
        Plot("energy", "time [s]", "energy / energy at the start", points=[("free shaft", times, relative)])
    )
    note = f"after {times[-1]:.0f} s {relative[-1]:.2f} are left"
    growth = max(0.0, float(relative.max()) - 1.0)
    return [Row("energy", float(relative.max()), 1.0, growth, 0.01, "", note)]


def energy_loss(run: Run) -> list[Row]:
    """Measure the rate at which a shaft swinging in its first mode loses energy, against that of its damping.

    Let go from the shape under a load across its end, it keeps to its first mode after a quarter of a second. A mode
    of angular frequency w loses energy at the rate t w^2, where t is the damping over the stiffness of a hinge (Kelvin
    and Voigt).
    """
    sim, loads = loose_shaft(run)
    loads.force[0, -1, 0] = PLUCK
    settle(sim)
    loads.force.zero_()
    times, values = energies(sim, SETTLED + 1.0)
    start = int(np.searchsorted(times, SETTLED))
    loss = -float(np.polyfit(times[start:], np.log(values[start:]), 1)[0])
    spec = proximal_spec()
    length, _ = beam(sim)
    mass = float(spec.link_mass[1] / spec.link_length[1])
    damped = spec.damping_time * FIRST_MODE**4 * rigidity(sim) / (mass * length**4)
    plot = Plot("energy_loss", "time [s]", "energy / energy at the start")
    plot.points.append(("free shaft", times, np.array(values) / values[0]))
    plot.lines.append(("Kelvin and Voigt", times, np.exp(-damped * np.array(times))))
    run.plots.append(plot)
    return [relative("energy_loss", loss, damped, 0.10, "1/s")]


def total_energy(sim: Any) -> float:
    """Return the kinetic and elastic energy of the first world's scope [J]."""
    import torch
    import warp as wp

    from arcgym.utils.math import quat_apply_inverse

    data, model, stage = sim.endoscope.data, sim.model, sim.endoscope.stage
    mass = wp.to_torch(model.body_mass)
    inertia = wp.to_torch(model.body_inertia)
    spin = quat_apply_inverse(data.body_quat_w[0], data.body_ang_vel_w[0])
    kinetic = (mass * data.body_lin_vel_w[0].square().sum(dim=1)).sum()
    kinetic = kinetic + torch.einsum("li,lij,lj->", spin, inertia, spin)
    kinetic = kinetic + (wp.to_torch(model.joint_armature) * data.joint_vel[0].square()).sum()
    hinges = stage.by_turn(stage.hinge_stiffness, stage.twist_stiffness)
    drives = [stage.slide_drive.stiffness, stage.roll_drive.stiffness, *hinges]
    stretch = data.joint_pos[0] - data.joint_pos_target[0]
    elastic = (torch.tensor(drives, dtype=torch.float32, device=sim.device) * stretch.square()).sum()
    return 0.5 * float(kinetic + elastic)


def parked(run: Run) -> list[Row]:
    """Measure the way of the farthest-moving link of a scope that rests in the bend for a minute."""
    sim = push(run, BEND, DEPTH, rest=2.0).sim
    links, steps = sim.endoscope.data.body_pos_w, round(CONTROL_STEP / sim.physics_dt)
    start, drift = links.clone(), []
    for _ in range(round(60.0 / CONTROL_STEP)):
        sim.step(steps)
        drift.append(float((links - start).norm(dim=-1).max()))
    times = CONTROL_STEP * np.arange(1, len(drift) + 1)
    shown = slice(None, None, 10)
    plot = Plot("parked_drift", "time [s]", "way of the link moved farthest [µm]")
    plot.points.append(("resting scope", times[shown], 1.0e6 * np.array(drift[shown])))
    run.plots.append(plot)
    return [absolute("parked_drift", max(drift), 0.0, 0.001, "m")]
