# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Dead loads on scope and wall of a simulation, and the wait until it stands still under them."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
import warp as wp

from arcgym.benchmarks.fidelity.load_kernels import add_loads

WEAK_SPRING = 1.0e-3
"""Stiffness of the far-away springs that act as dead loads on the wall [N/m]."""


class LinkLoads:
    """Loads on the links of all worlds, added to what the scope's drives do. N worlds, L links."""

    def __init__(self, sim: Any):
        """Add zero loads to the simulation, before its first step."""
        n, links, device = sim.num_envs, sim.endoscope.num_bodies, sim.device
        vectors = [torch.zeros(n, links, 3, device=device) for _ in range(3)]
        self.point, self.force, self.torque = vectors
        """Where the force acts in the link's frame [m], force [N], torque [N m]; shape (N, L, 3)."""
        self.guide = torch.zeros(n, links, device=device)
        """Sideways spring from the point to the Z axis [N/m], shape (N, L)."""
        arrays = [wp.from_torch(v.view(-1, 3), dtype=wp.vec3) for v in vectors] + [wp.from_torch(self.guide.view(-1))]
        drive = sim.actuation.apply

        def apply(state: Any, control: Any, ring: Any, dt: float) -> None:
            drive(state, control, ring, dt)
            args = [state.body_q, *arrays, dt, state.body_f, sim.actuation.resistance]
            wp.launch(add_loads, (links, n), args, device=device)

        sim.actuation.apply = apply


def load_wall(sim: Any, force: np.ndarray) -> None:
    """Put dead loads on the vertices of a wall without anchors [N], shape (V, 3).

    Raises:
        ValueError: If the wall has anchors; their springs take the loads.
    """
    anchors = sim.wall.nodes.anchors
    if anchors.stiffness.numpy().any():
        raise ValueError("The wall has anchors; loads need one with anchor_stiffness=tubes.FREE.")
    anchors.rest.assign((anchors.rest.numpy() + force[:, None] / WEAK_SPRING).astype(np.float32))
    anchors.stiffness.fill_(WEAK_SPRING)
    anchors.loose.fill_(1.0)


def settle(sim: Any, tolerance: float = 2.0e-6, longest: float = 30.0, block: int = 24) -> float:
    """Step until nothing moves by more than ``tolerance`` [m] in half a second, and return the time taken [s].

    Dynamic relaxation: velocities are set to zero whenever the kinetic energy of a world has passed its peak, which
    leaves the equilibrium where it is and gets there much sooner.
    """
    state, wall = sim.endoscope.data, sim.colon.data
    energy = torch.zeros(sim.num_envs, device=sim.device)
    last, elapsed = places(sim), 0.0
    blocks = max(1, round(0.5 / (block * sim.physics_dt)))
    while elapsed < longest:
        for _ in range(blocks):
            sim.step(block)
            now = state.body_lin_vel_w.square().sum((1, 2)) + wall.nodal_vel_w.square().sum((1, 2))
            falling = now < energy
            state.joint_vel[falling] = 0.0
            wall.nodal_vel_w[falling] = 0.0
            energy = torch.where(falling, 0.0, now)
        elapsed += blocks * block * sim.physics_dt
        here = places(sim)
        if (here - last).abs().max() < tolerance:
            break
        last = here
    return elapsed


def places(sim: Any) -> torch.Tensor:
    """Return the positions of all links and wall vertices [m], shape (N, L + V, 3)."""
    return torch.cat([sim.endoscope.data.body_pos_w, sim.colon.data.nodal_pos_w], dim=1).clone()
