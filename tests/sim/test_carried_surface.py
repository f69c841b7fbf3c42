# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contact with a fine surface that the wall carries: a tube of radius 20 mm with a fold of 6 mm all round at 0.1 m."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from static_force import static_force
from tiny import tiny_colon_stage
from tiny_sim import TinySim

from arcgym.anatomy import write_colon
from arcgym.anatomy.stage import ContactSurface
from arcgym.benchmarks.fidelity.brute_force import sample_contacts
from arcgym.sim import ContactCfg, Simulation

RINGS, SECTORS, PARTS = 17, 8, 3
FOLD, WIDTH = 0.006, 0.004


def folded_surface(fold: float = FOLD) -> ContactSurface:
    """Three rows and columns for each of the wall's, and the pole; a fold of 6 mm where z is 0.1 m."""
    ring, sector = np.arange((RINGS - 1) * PARTS + 1) / PARTS, np.arange(SECTORS * PARTS) / PARTS
    z, angle = 0.0125 * ring, sector * 2.0 * np.pi / SECTORS
    radius = 0.02 - fold * np.exp(-(((z - 0.1) / WIDTH) ** 2))
    round_lumen = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    tube = np.concatenate([radius[:, None, None] * round_lumen, np.broadcast_to(z[:, None, None], (49, 24, 1))], axis=2)
    points = np.concatenate([tube, np.tile([0.0, 0.0, 0.2], (1, 24, 1))])
    at = np.minimum(np.r_[ring, 16.0], 16.0)[:, None].repeat(24, axis=1).ravel()
    around = np.tile(sector, 50)
    low, left = np.minimum(at.astype(int), RINGS - 2), around.astype(int)
    u, v, right = at - low, around - left, (left + 1) % SECTORS
    index = np.stack([low * 8 + left, (low + 1) * 8 + left, (low + 1) * 8 + right, low * 8 + right], axis=1)
    weight = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
    return ContactSurface(points.reshape(-1, 3).astype(np.float32), 24, index.astype(np.int32), weight.astype("f4"))


@pytest.fixture(scope="module")
def folded(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    folder = tmp_path_factory.mktemp("folded")
    made = TinySim(folder)
    write_colon(replace(tiny_colon_stage(texture_folder=folder), contact=folded_surface()), folder / "colon.usda")
    return made


@pytest.fixture(scope="module", params=["fine", "rows"])
def sim(folded: TinySim, request: pytest.FixtureRequest) -> Simulation:
    return folded("capsule", contact=ContactCfg(surface=request.param))


def place(sim: Simulation, x: float, z: float = 0.1) -> None:
    """Put the capsule, of radius 5 mm, parallel to the tube at ``x`` [m] from its axis; find its contacts."""
    sim.endoscope.data.joint_pos[0] = torch.tensor([x, 0.0, z, 0.0, 0.0, 0.0, 1.0])
    sim.endoscope.data.joint_vel.zero_()
    sim.forward()
    sim.contact.memory["contact_slide"].zero_()
    sim.coupling.find_contacts()


def force_on_capsule(sim: Simulation) -> np.ndarray:
    """Force of the wall on the resting capsule [N]."""
    sim.coupling.load_contacts(0.0, 1.0e-9)
    return sim.coupling.solver.loads.wrench.numpy()[0, 0, :3]


def test_points_are_those_of_the_stage_and_turn_with_the_wall(sim: Simulation) -> None:
    surface, rest = folded_surface().points, sim.nodal_pos.numpy().copy()
    if sim.cfg.contact.surface == "rows":
        surface = surface.reshape(-1, SECTORS * PARTS, 3)[:, ::PARTS].reshape(-1, 3)
    assert sim.contact.carried is not None
    np.testing.assert_allclose(sim.contact.carried.update(sim.nodal_pos).numpy()[:, 0], surface, atol=1e-6)
    turn, shift = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]), np.array([0.1, 0.2, 0.3])
    sim.nodal_pos.assign((rest @ turn.T + shift).astype(np.float32))
    moved = sim.contact.carried.update(sim.nodal_pos).numpy()[:, 0]
    sim.nodal_pos.assign(rest)
    np.testing.assert_allclose(moved, surface @ turn.T + shift, atol=2e-6)


def test_a_capsule_touches_a_fold_that_the_wall_does_not_have(folded: TinySim, sim: Simulation) -> None:
    coarse = folded("capsule")
    for one in (sim, coarse):
        place(one, x=0.0100)  # its side is 15 mm from the axis: 1 mm beyond the fold's edge, 5 mm from the wall
    assert force_on_capsule(sim)[0] < -1.0
    np.testing.assert_array_equal(force_on_capsule(coarse), 0.0)
    place(sim, x=0.0100, z=0.05)
    np.testing.assert_array_equal(force_on_capsule(sim), 0.0)


def test_what_the_fold_does_to_the_capsule_it_does_to_the_wall(sim: Simulation) -> None:
    place(sim, x=0.0095)
    on_wall = static_force(sim).numpy()[:, 0]
    np.testing.assert_allclose(on_wall.sum(axis=0), -force_on_capsule(sim), rtol=1e-3, atol=1e-4)
    pressed = np.flatnonzero(np.linalg.norm(on_wall, axis=1) > 1e-2)
    assert set(sim.colon.wall.ring[pressed]) <= {7, 8, 9}  # the fold stands on ring 8, at 0.1 m


@pytest.mark.parametrize("x", [0.0, 0.0095, 0.0125])
def test_no_face_of_the_fine_surface_is_missed(sim: Simulation, x: float) -> None:
    place(sim, x)
    sample = sample_contacts(sim)[0]
    assert not sample.missed.any()
    assert (len(sample.missed) > 0) == (x > 0.0)
    assert int(sim.dropped_contacts[0]) == 0


def test_a_capsule_that_is_pushed_on_the_fold_moves_the_wall(folded: TinySim) -> None:
    sim = folded("capsule", contact=ContactCfg(surface="fine"), colon={"material": "in_situ"})
    place(sim, x=0.0100)
    sim.step(48)
    moved = np.abs(sim.nodal_pos.numpy()[:, 0] - sim.colon.wall.points).max(axis=1)
    assert np.isfinite(moved).all() and 1e-5 < moved.max() < 5e-3
    assert sim.colon.wall.ring[moved.argmax()] in (7, 8, 9)


def test_a_stage_without_a_contact_surface_is_refused(tiny_sim: TinySim) -> None:
    with pytest.raises(ValueError, match=r"has no contact surface.*surface=wall"):
        tiny_sim("capsule", contact=ContactCfg(surface="fine"))


def test_a_surface_that_does_not_divide_the_cells_is_refused(folded: TinySim, tmp_path: Path) -> None:
    surface = folded_surface()
    shifted = replace(surface, skin_indices=np.roll(surface.skin_indices, 1, axis=0))
    stage = replace(tiny_colon_stage(texture_folder=tmp_path), contact=shifted)
    path = write_colon(stage, tmp_path / "colon.usda")
    with pytest.raises(ValueError, match="must divide the wall's cells evenly"):
        folded("capsule", contact=ContactCfg(surface="fine"), colon={"usd_path": str(path)})


def test_every_patient_has_folds_of_its_own(tmp_path: Path) -> None:
    tube, paths = TinySim(tmp_path), []
    for name, fold in (("deep", FOLD), ("shallow", 0.5 * FOLD)):
        stage = replace(tiny_colon_stage(texture_folder=tmp_path), contact=folded_surface(fold))
        paths.append(str(write_colon(stage, tmp_path / name / "colon.usda")))

    def pushed(usd_path: object, num_envs: int) -> Simulation:
        sim = tube("capsule", num_envs=num_envs, colon={"usd_path": usd_path}, contact=ContactCfg(surface="fine"))
        sim.endoscope.data.joint_pos[:] = torch.tensor([0.011, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0])
        sim.forward()
        sim.step(5)
        return sim

    both = pushed(paths[::-1], 2)
    for world, path in enumerate(paths[::-1]):
        alone = pushed(path, 1)
        assert torch.equal(both.colon.data.nodal_pos_w[world], alone.colon.data.nodal_pos_w[0])
        assert torch.equal(both.endoscope.data.link_force_w[world], alone.endoscope.data.link_force_w[0])
    assert both.endoscope.data.link_force_norm[1] > 2.0 * both.endoscope.data.link_force_norm[0]


def test_what_is_far_from_the_links_stays_behind_and_changes_no_contact(sim: Simulation) -> None:
    place(sim, x=0.0095)
    carried, records = sim.contact.carried, sim.contact.records
    assert carried is not None
    near = carried.near.numpy()[:, 0]
    found = [one.numpy().copy() for one in (records.start, records.face, records.distance, records.normal)]
    assert near[7:9].all() and not near[:4].any() and not near[13:].any()
    sim.contact.measure_surface(sim.nodal_pos)
    sim.contact._find(sim.state.body_q)
    sim.contact._record(sim.nodal_pos, sim.contact.points, sim.state.body_q)
    for one, before in zip((records.start, records.face, records.distance, records.normal), found, strict=True):
        np.testing.assert_array_equal(one.numpy(), before)
