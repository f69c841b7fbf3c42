# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Forces between scope, wall and base at rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp

from arcgym.benchmarks.fidelity.load_kernels import contact_on_wall
from arcgym.benchmarks.fidelity.pushes import BEND, CONTROL_STEP, DEPTH, push
from arcgym.benchmarks.fidelity.rows import Plot, Row, Run, relative
from arcgym.sim.wall.wall_solver import wall_contacts


def balance(run: Run) -> list[Row]:
    """Measure the forces on scope, wall and base once the scope rests in the bend, mean over a control step."""
    sim = push(run, BEND, DEPTH, rest=2.0).sim
    steps, data = round(CONTROL_STEP / sim.physics_dt), sim.endoscope.data
    samples = []
    for _ in range(steps):
        sim.step(1)
        on_scope = data.link_force_w[0].sum(dim=0).cpu().numpy().astype(float)
        samples.append((on_scope, contact_force_on_wall(sim), data.base_force.item()))
    on_scope, on_wall, base = (np.mean(values, axis=0) for values in zip(*samples, strict=True))
    run.plots.append(balance_plot(samples, sim.physics_dt))
    size = float(np.linalg.norm(on_scope))
    error = float(np.linalg.norm(on_scope + on_wall)) / size
    action = Row("action_reaction", float(np.linalg.norm(on_wall)), size, error, 0.02, "N", "error of the vector sum")
    return [action, relative("base_force", float(base), -float(on_scope[2]), 0.02, "N")]


def balance_plot(samples: list[tuple[np.ndarray, np.ndarray, float]], dt: float) -> Plot:
    """Draw both forces between wall and scope, and both along the base, over time."""
    time = 1.0e3 * dt * np.arange(len(samples))
    plot = Plot("balance", "time [ms]", "force [N]")
    plot.lines.append(("of the wall on the scope", time, [float(np.linalg.norm(s)) for s, _, _ in samples]))
    plot.points.append(("of the scope on the wall", time, [float(np.linalg.norm(w)) for _, w, _ in samples]))
    plot.lines.append(("of the wall along the base", time, [-float(s[2]) for s, _, _ in samples]))
    plot.points.append(("on the base", time, [b for _, _, b in samples]))
    return plot


def contact_force_on_wall(sim: Any) -> np.ndarray:
    """Return the sum of the contact forces on the wall of a single world in its last step [N], shape (3,)."""
    poses = (sim.state.body_q, sim.coupling.body_q_prev)
    contacts = wall_contacts(sim.contact, sim.cfg.dt, sim.wall.x_prev, *poses)
    out = wp.zeros_like(sim.nodal_pos)
    wp.launch(contact_on_wall, out.shape, [contacts, sim.nodal_pos], [out], device=sim.device)
    return out.numpy().astype(float).sum(axis=(0, 1))
