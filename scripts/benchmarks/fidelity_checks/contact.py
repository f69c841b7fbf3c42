# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contact forces: balance at rest, friction around a bend, and a wall that lets nothing through."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fidelity_checks.insertion import BEND, CONTROL_STEP, DEPTH, push
from fidelity_checks.loads import LinkLoads
from fidelity_checks.models import Tube, build, wall_measures
from fidelity_checks.references import capstan_ratio
from fidelity_checks.table import Plot, Row, Run, absolute, check, relative

LOOP = Tube(0.50, math.pi, 0.10, 0.08)
"""Tube that turns back, for pulling a rope around it."""
LIMP = 1.0e-4
"""Bending rigidity of the rope [N m^2]: a hundredth of the bending section's."""
PULL = 3.0
"""Dead load on the rope's end [N]."""
FRICTION = (0.0, 0.05, 0.1, 0.15, 0.2)
"""Friction coefficients of the worlds."""
SHOVE = 20.0
"""Force on a link [N]."""
SHOVED = 16
"""Links that are shoved, from the tip backwards: those beyond the held end of the tube."""
SIDES = ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0))
"""Directions of the force, in the link's frame."""


@check("action_reaction", "base_force")
def balance(run: Run) -> list[Row]:
    """Forces on scope, wall and base once the scope rests in the bend, mean over a control step."""
    sim = push(run, BEND, DEPTH, rest=2.0).sim
    steps, data = round(CONTROL_STEP / sim.physics_dt), sim.endoscope.data
    samples = []
    for _ in range(steps):
        sim.step(1)
        on_scope = data.wall_force_w[0].sum(dim=0).cpu().numpy().astype(float)
        samples.append((on_scope, contact_force_on_wall(sim), data.base_force.item()))
    on_scope, on_wall, base = (np.mean(values, axis=0) for values in zip(*samples, strict=True))
    run.plots.append(balance_plot(samples, sim.physics_dt))
    size = float(np.linalg.norm(on_scope))
    error = float(np.linalg.norm(on_scope + on_wall)) / size
    action = Row("action_reaction", float(np.linalg.norm(on_wall)), size, error, 0.02, "N", "error of the vector sum")
    return [action, relative("base_force", float(base), -float(on_scope[2]), 0.02, "N")]


def balance_plot(samples: list[tuple[np.ndarray, np.ndarray, float]], dt: float) -> Plot:
    """Sizes of both forces between wall and scope, and of both along the base, over time."""
    time = 1.0e3 * dt * np.arange(len(samples))
    plot = Plot("balance", "time [ms]", "force [N]")
    plot.lines.append(("of the wall on the scope", time, [float(np.linalg.norm(s)) for s, _, _ in samples]))
    plot.points.append(("of the scope on the wall", time, [float(np.linalg.norm(w)) for _, w, _ in samples]))
    plot.lines.append(("of the wall along the base", time, [-float(s[2]) for s, _, _ in samples]))
    plot.points.append(("on the base", time, [b for _, _, b in samples]))
    return plot


def contact_force_on_wall(sim: Any) -> np.ndarray:
    """Sum of the contact forces on the wall of a single world as its last step saw them [N], shape (3,)."""
    import warp as wp

    from arcgym.sim.wall.wall_solver import wall_contacts
    from fidelity_checks.load_kernels import contact_on_wall

    poses = (sim.state.body_q, sim.coupling.body_q_prev)
    contacts = wall_contacts(sim.contact, sim.cfg.dt, sim.wall.x_prev, *poses)
    out = wp.zeros_like(sim.nodal_pos)
    wp.launch(contact_on_wall, out.shape, [contacts, sim.nodal_pos, out], device=sim.device)
    return out.numpy().astype(float).sum(axis=(0, 1))


@check("capstan", quick=True)
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


def surface_lever(sim: Any) -> float:
    """Distance of the shaft's surface from the bend's centre over that of its axis, both along the inner side.

    Friction acts on the surface, which turns on a shorter lever than the axis, where the tension is.
    """
    radius = float(sim.endoscope.stage.link_radius[0])
    surface = LOOP.bend_radius - wall_measures().radius
    return surface / (surface + radius)


def rope(run: Run) -> tuple[Any, LinkLoads]:
    """Worlds of different friction with a limp shaft around the loop, its end loaded along the tube."""
    import torch

    from arcgym.assets import PROXIMAL_CFG

    limp = {"shaft_rigidity": LIMP, "tip_rigidity": LIMP}
    sim = build(run, PROXIMAL_CFG, LOOP, len(FRICTION), endoscope=limp)
    loads = LinkLoads(sim)
    inserted = LOOP.length - 0.06
    follow(sim, LOOP, inserted)
    sim.endoscope.write_friction_to_sim(torch.tensor(FRICTION, device=sim.device))
    _, angle = LOOP.frame(np.array([LOOP.length]))
    loads.force[:, -1] = PULL * torch.tensor([0.0, math.sin(angle[0]), math.cos(angle[0])], device=sim.device)
    return sim, loads


def follow(sim: Any, tube: Tube, inserted: float) -> None:
    """Lay the shaft along the centreline of a tube, inserted by a length [m]."""
    stage, data = sim.endoscope.stage, sim.endoscope.data
    ends = inserted - sim.endoscope.tip_offset + 0.5 * stage.link_length[-1]
    place = ends - stage.total_length + np.cumsum(stage.link_length)[:-1]
    pitch = np.arange(0, len(place), 2)  # hinges 1, 3, ... turn about X
    edges = np.r_[-1.0, 0.5 * (place[pitch][1:] + place[pitch][:-1]), tube.length]
    turn = np.diff(tube.frame(np.maximum(edges, 0.0))[1])
    for coordinate in (data.joint_pos, data.joint_pos_target):
        coordinate[:, 0] = inserted - sim.endoscope.rest_insertion
    for hinge, angle in zip(pitch, turn, strict=True):
        data.joint_pos[:, int(stage.bend_coords[hinge])] = -float(angle)
    sim.contact.ring.fill_(-1)
    sim.forward()


def pull_rope(sim: Any, loads: LinkLoads, speed: float = 0.05) -> tuple[np.ndarray, np.ndarray]:
    """Withdraw the rope; mean pull on its base [N] and angle it turns by [rad] in each world."""
    import torch

    from arcgym.utils.math import quat_apply

    data, still = sim.endoscope.data, torch.zeros(sim.num_envs, device=sim.device)
    sim.endoscope.set_insertion_command(still - speed, still)
    sim.step(round(0.6 / sim.physics_dt))
    pulls, angles = [], []
    axis = torch.tensor([0.0, 0.0, 1.0], device=sim.device).expand(*data.body_quat_w.shape[:2], 3)
    for _ in range(12):
        sim.step(round(0.05 / sim.physics_dt))
        pulls.append(-data.base_force.cpu().numpy())
        direction = quat_apply(data.body_quat_w, axis)
        entry = (data.body_pos_w[0, :, 2] - 0.5 * LOOP.bend_start).abs()[: data.body_pos_w.shape[1] // 2 + 20].argmin()
        cosine = (direction[:, entry] * loads.force[:, -1] / PULL).sum(dim=1)
        angles.append(torch.arccos(cosine.clamp(-1.0, 1.0)).cpu().numpy())
    return np.mean(pulls, axis=0), np.mean(angles, axis=0)


@check("tunnelling")
def tunnelling(run: Run) -> list[Row]:
    """Links outside the lumen while 20 N push one of them against the softest preset, for a second.

    The worlds differ in the link pushed, from the tip backwards, and in the side: to either side of the bend's plane,
    out of the bend and into it; the tip is pushed forwards and backwards, too. Links of a world that is not finite
    count as outside.
    """
    import torch

    from arcgym.assets import PROXIMAL_CFG
    from arcgym.utils.math import quat_apply

    shoves = [(-1 - link, side) for link in range(SHOVED) for side in SIDES]
    shoves += [(-1, (0.0, 0.0, along)) for along in (1.0, -1.0)]
    sim = build(run, PROXIMAL_CFG, BEND, len(shoves), {"material": "in_situ"})
    loads = LinkLoads(sim)
    follow(sim, BEND, DEPTH)
    sim.step(24)
    for world, (link, side) in enumerate(shoves):
        quat = sim.endoscope.data.body_quat_w[world, link]
        loads.force[world, link] = SHOVE * quat_apply(quat, torch.tensor(side, device=sim.device))
    events, moved, times = np.zeros(sim.num_envs), [], []
    for _ in range(20):
        sim.step(24)
        events += [links_outside(sim, world) for world in range(sim.num_envs)]
        moved.append(sim.colon.data.nodal_displacement.nan_to_num(0.0).amax(dim=1).cpu().numpy())
        times.append(24 * len(moved) * sim.physics_dt)
    deepest, displacement = float(np.max(moved)), 1.0e3 * np.array(moved)
    plot = Plot("tunnelling", "time [s]", "largest displacement of the wall [mm]")
    names = ("+X", "-X", "+Y", "-Y")
    plot.points += [(f"tip to {name}", times, displacement[:, k]) for k, name in enumerate(names)]
    plot.lines.append(("any link, largest", times, displacement.max(axis=1)))
    run.plots.append(plot)
    note = f"in {np.count_nonzero(events)} of {sim.num_envs} worlds, {int(sim.non_finite.sum())} not finite; "
    note += f"the wall moved by up to {1e3 * deepest:.0f} mm"
    return [absolute("tunnelling", float(events.sum()), 0.0, 0.0, "", note)]


def links_outside(sim: Any, world: int) -> int:
    """Links whose centre is outside the lumen: the inner surface winds around it by less than half.

    Links near the open ends of the tube are left out.
    """
    data, faces, margin = sim.endoscope.data, sim.contact.surface.faces.numpy(), 4
    if bool(sim.non_finite[world]):
        return sim.endoscope.num_bodies
    points = sim.colon.data.nodal_pos_w[world].cpu().numpy().astype(float)
    centers = data.body_pos_w[world].cpu().numpy().astype(float)
    ring = sim.contact.ring.numpy()[world]
    centers = centers[(ring >= margin) & (ring < sim.colon.num_rings - margin)]
    return int((winding(points[faces], centers) < 0.5).sum())


def winding(triangles: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Winding number of a surface around points, shape (n,) (solid angles: van Oosterom and Strackee 1983)."""
    a, b, c = (triangles[None, :, k] - points[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    volume = np.einsum("pfi,pfi->pf", a, np.cross(b, c))
    dots = [(u * v).sum(axis=2) * w for u, v, w in ((a, b, lc), (b, c, la), (c, a, lb))]
    return np.arctan2(volume, la * lb * lc + sum(dots)).sum(axis=1) / (2.0 * np.pi)
