# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A scope of ten links pushed with a bent tip into a soft tube that moves out of its way by more than a millimeter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch
from static_force import static_force
from tiny_scope import tiny_scope_spec
from tiny_sim import TinySim

from arcgym.assets.endoscope_stage import write_endoscope
from arcgym.sim import ContactCfg, Simulation

SOFT = {"youngs_modulus": 5.0e5}
SOLID = {**SOFT, "wall_model": "solid"}
"""The wall that plain Newton can simulate."""


@pytest.fixture(scope="module")
def narrow(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    """Return a tube of 16 mm radius, and a scope with more hinge damping: in plain Newton another shakes at rest."""
    tiny = TinySim(tmp_path_factory.mktemp("narrow"), radius=0.016)
    calm = replace(tiny_scope_spec("proximal", 10), damping_time=0.1, armature_time=3.0e-4)
    write_endoscope(calm, tiny.folder / "proximal_10.usda")
    return tiny


def settled(narrow: TinySim, colon: dict[str, object] = SOFT, **cfg: object) -> Simulation:
    """Push to the end of the shaft in about 1 s while bending, then 0.5 s of rest."""
    sim = narrow(links=10, colon=colon, **cfg)
    sim.endoscope.set_insertion_command(torch.tensor([0.1]), torch.tensor([0.0]))
    sim.endoscope.set_bending_command(torch.tensor([1.2]), torch.tensor([0.2]))
    for _ in range(15):
        sim.step(48)
    return sim


@pytest.fixture(scope="module")
def two_level(narrow: TinySim) -> Simulation:
    return settled(narrow)


@pytest.mark.slow  # 720 steps of plain Newton
def test_two_level_agrees_with_plain_newton(narrow: TinySim) -> None:
    two_level, newton = settled(narrow, SOLID), settled(narrow, SOLID, solver="newton", mass_scaling=3.0)
    tips, forces, moved = (
        [read(sim) for sim in (two_level, newton)]
        for read in (
            lambda sim: sim.endoscope.data.tip_pos_w[0],
            lambda sim: sim.endoscope.data.link_force_w[0].norm(dim=1).max().item(),
            lambda sim: sim.colon.data.nodal_displacement.max().item(),
        )
    )
    assert (tips[0] - tips[1]).norm() < 0.0005
    assert forces[0] == pytest.approx(forces[1], rel=0.15)
    assert moved[0] == pytest.approx(moved[1], rel=0.15)
    assert moved[0] > 0.001


def test_plain_newton_refuses_what_differs_between_worlds(narrow: TinySim) -> None:
    sim = narrow(links=6, colon=SOLID, solver="newton")
    with pytest.raises(ValueError, match="one tissue for all worlds.*env.events.stiffness=null"):
        sim.colon.write_stiffness_scale_to_sim(torch.ones(1))
    with pytest.raises(ValueError, match="one friction coefficient for all worlds"):
        sim.endoscope.write_friction_to_sim(torch.ones(1))


@pytest.mark.parametrize(("substeps", "made"), [(1, 2), (4, 4)])
def test_plain_newton_steps_the_wall_in_every_substep(
    narrow: TinySim, substeps: int, made: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It needs two of them."""
    sim = narrow(links=6, colon=SOLID, solver="newton", scope_substeps=substeps, use_graph=False)
    solver, lengths = sim.coupling.solver, []
    step = solver.step
    monkeypatch.setattr(solver, "step", lambda *args: (lengths.append(args[-1]), step(*args)))
    sim.step(1)
    assert lengths == [pytest.approx(sim.physics_dt / made)] * made


def test_plain_newton_refuses_to_tell_about_penetration(narrow: TinySim) -> None:
    sim = narrow(links=6, colon=SOLID, solver="newton")
    with pytest.raises(ValueError, match="does not measure wall penetration.*env.terminations.wall_penetrated=null"):
        _ = sim.wall_penetrated


def force_on_wall(sim: Simulation, with_contact: bool) -> np.ndarray:
    """Force on each vertex that moves [N], shape (V, 3)."""
    if not with_contact:
        sim.contact.records.vertex_head.fill_(-1)
    return static_force(sim).numpy()[:, 0]


@pytest.fixture(scope="module")
def frictionless(narrow: TinySim) -> Simulation:
    return settled(narrow, contact=ContactCfg(friction=0.0))


def test_at_rest_the_wall_is_pushed_as_hard_as_the_scope(frictionless: Simulation) -> None:
    sim = frictionless
    sim.step(1)
    on_scope = sim.endoscope.data.link_force_w[0].numpy()
    on_wall = force_on_wall(sim, with_contact=True) - force_on_wall(sim, with_contact=False)
    size = np.linalg.norm(on_scope, axis=1).sum()
    assert size > 1.0
    assert np.linalg.norm(on_scope.sum(axis=0) + on_wall.sum(axis=0)) < 0.02 * size


def test_base_and_introducer_carry_what_the_wall_pushes(frictionless: Simulation) -> None:
    sim = frictionless
    sim.step(48)
    along = sim.endoscope.data.link_force_w[0, :, 2].sum().item()
    assert sim.endoscope.data.base_force.item() == pytest.approx(-along, abs=0.01)


def test_a_parked_scope_stays_parked(frictionless: Simulation) -> None:
    sim = frictionless
    before = sim.endoscope.data.tip_pos_w.clone()
    sim.step(240)
    assert (sim.endoscope.data.tip_pos_w - before).norm() < 2e-5
    assert sim.colon.data.nodal_vel_w.abs().max() < 2e-4


def test_no_link_is_outside_the_wall(two_level: Simulation) -> None:
    axis_distance = two_level.endoscope.data.body_pos_w[0, :, :2].norm(dim=1)
    assert axis_distance.max() < 0.016 + two_level.colon.data.nodal_displacement.max() - 0.0064


def test_no_wall_element_is_crushed(two_level: Simulation) -> None:
    triangles = two_level.colon.wall.triangles
    area = [
        np.linalg.norm(
            np.cross(p[triangles[:, 1]] - p[triangles[:, 0]], p[triangles[:, 2]] - p[triangles[:, 0]]), axis=1
        )
        for p in (two_level.nodal_pos.numpy()[:, 0].astype(float), two_level.colon.wall.points.astype(float))
    ]
    ratio = area[0] / area[1]
    assert 0.7 < ratio.min() and ratio.max() < 1.3


def test_what_the_links_owe_the_wall_is_paid_while_they_move(narrow: TinySim) -> None:
    # What the wall has not been given is at any time the debt: over a push of half a second it is a small part.
    sim = narrow(links=10, colon=SOFT)
    sim.endoscope.set_insertion_command(torch.tensor([0.1]), torch.tensor([0.0]))
    sim.endoscope.set_bending_command(torch.tensor([1.2]), torch.tensor([0.2]))
    given, most = torch.zeros(3), 0.0
    for _ in range(240):
        sim.step(1)
        given += sim.endoscope.data.link_force_w[0].sum(dim=0)
        most = max(most, sim.contact.memory["contact_debt"][0].view(-1, 3).sum(dim=0).norm().item())
    assert 0.0 < most < 0.02 * given.norm().item()
