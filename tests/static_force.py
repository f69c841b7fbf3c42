# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Force on the wall as it lies, which a step never needs alone."""

from __future__ import annotations

import warp as wp

from arcgym.sim import Simulation


def static_force(sim: Simulation, x: wp.array | None = None) -> wp.array:
    """Return the force on every mobile vertex at rest [N], shape (V, W), vec3, without friction.

    Args:
        sim: The simulation, with its contacts at hand.
        x: Wall positions [m], shape (V, W), vec3; those of the simulation by default.
    """
    wall, x = sim.wall, sim.nodal_pos if x is None else x
    force = wp.zeros_like(x)
    contacts = wall._contacts(sim.contact, x, sim.state.body_q, sim.state.body_q)
    wall.self_contact.measure(x)
    if wall.surroundings is not None:
        wall.surroundings.measure(x, wall.tissue, wall.dt)
    if wall.gas is not None:
        wall.gas.hold(x)
    wall._measure(x)
    inertial = x
    if wall.weight is not None:
        inertial = wp.clone(x)
        wall.weight.add(wall.nodes, wall.tissue, wall.dt, inertial)
    if wall.on_gpu:
        wall._pack(contacts, x)
    wall._residual(x, inertial, contacts, force)
    if wall.kept is not None:
        wall.kept.forget_rows()
    return force
