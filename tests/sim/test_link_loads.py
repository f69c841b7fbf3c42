# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Loads of the contacts on the links, summed by a block of a GPU a world, against the plain kernel."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from load_rows import read_rows

from arcgym.sim.contact.contact_kernels import ContactLaw, ContactRecords, LinkShapes
from arcgym.sim.contact.link_load_block_kernels import THREADS, load_contacts_by_block
from arcgym.sim.contact.link_load_kernels import MovingLink, load_contacts
from arcgym.sim.scope.load_row_kernels import FOURS, LoadRows
from arcgym.sim.scope.scope_kernels import LinkLoads
from arcgym.utils.warp_vote_kernels import GROUP

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import warp as wp

WORLDS, LINKS, CAPACITY, RADIUS, LENGTH = 5, 70, 2000, 0.006, 0.02
CUDA = pytest.param("cuda:0", marks=pytest.mark.skipif(not wp.is_cuda_available(), reason="needs CUDA"))


def contact_counts(generator: np.random.Generator) -> np.ndarray:
    """Contacts of each link, shape (W, L): 1000 of many links, 800 of one, 512 of three, 20, none."""
    counts = np.zeros((WORLDS, LINKS), np.int32)
    counts[0, 10:60] = generator.multinomial(1000, np.full(50, 0.02)) * (generator.uniform(size=50) > 0.2)
    counts[1, 3] = 800
    counts[2, [0, 68, 69]] = 200, 56, 256
    counts[3, 35] = 20
    return counts


class Contacts:
    """Five worlds of links with contacts around them, of which a third is too far away to push."""

    def __init__(self, device: str):
        generator = np.random.default_rng(3)
        self.device = device
        counts = contact_counts(generator)
        turn = generator.normal(size=(WORLDS, LINKS, 4))
        turn /= np.linalg.norm(turn, axis=-1, keepdims=True)
        place = generator.uniform(-0.05, 0.05, (WORLDS, LINKS, 3))
        moved = place + generator.normal(0.0, 2.0e-4, place.shape)
        twist = generator.normal(0.0, 0.05, (WORLDS, LINKS, 6)) * [1.0, 1.0, 1.0, 10.0, 10.0, 10.0]
        self.inputs = [self._array(np.concatenate([moved, turn], -1).reshape(-1, 7), wp.transform)]
        self.inputs.append(self._array(twist.reshape(-1, 6), wp.spatial_vector))
        self.inputs.append(self._array(generator.normal(0.0, 0.001, (LINKS, 3)), wp.vec3))
        x = np.zeros((3 * CAPACITY, WORLDS, 3))
        self.records = self._records(counts, moved, generator, x)
        self.inputs += [self._array(x, wp.vec3), self._array(generator.normal(0.0, 0.02, x.shape), wp.vec3)]
        before = np.concatenate([place, turn], -1).reshape(-1, 7)
        self.inputs += [self._links(), self.records, self._law()]
        self.inputs += [self._array(generator.uniform(0.1, 0.4, WORLDS), float), self._array(before, wp.transform)]

    def _array(self, values: np.ndarray, dtype: Any) -> wp.array:
        return wp.array(values.astype(np.int32 if dtype in (int, wp.vec4i) else np.float32), dtype, device=self.device)

    def _links(self) -> LinkShapes:
        links = LinkShapes()
        links.half_length = self._array(np.full(LINKS, LENGTH / 2), float)
        links.radius = self._array(np.full(LINKS, RADIUS), float)
        return links

    def _law(self) -> ContactLaw:
        law = ContactLaw()
        law.stiffness, law.hardening, law.damping, law.deep_damping, law.relief = 800.0, 0.002, 0.5, 2.0, 0.3
        law.friction_stiffness, law.static_friction, law.slip_velocity = 300.0, 1.5, 0.002
        law.wall_radius, law.search_gap = 0.0005, 0.002
        return law

    def _records(
        self, counts: np.ndarray, place: np.ndarray, generator: np.random.Generator, x: np.ndarray
    ) -> ContactRecords:
        """Return contacts of the links at ``place``, shape (W, L, 3), and write their corners to ``x`` [m]."""
        slots = WORLDS * CAPACITY
        link = np.zeros((WORLDS, CAPACITY), np.int32)
        for world, count in enumerate(counts):
            link[world, : count.sum()] = np.repeat(np.arange(LINKS), count)
        away = generator.normal(size=(WORLDS, CAPACITY, 3))
        away /= np.linalg.norm(away, axis=-1, keepdims=True)
        point = np.take_along_axis(place, link[..., None], 1)
        point += away * (RADIUS + generator.uniform(-0.003, 0.014, (WORLDS, CAPACITY, 1)))
        corners = np.arange(3 * CAPACITY).reshape(CAPACITY, 3)[:, [0, 1, 2, 2]]
        for k in range(3):
            x[k::3] = point.swapaxes(0, 1)
        bary = generator.dirichlet(np.ones(3), slots)
        records = ContactRecords()
        records.capacity = CAPACITY
        start = np.concatenate([np.zeros((WORLDS, 1)), counts.cumsum(axis=1)], axis=1)
        records.start, records.link = self._array(start, int), self._array(link.ravel(), int)
        records.corners = self._array(np.tile(corners, (WORLDS, 1)), wp.vec4i)
        records.bary = self._array(np.concatenate([bary, np.zeros((slots, 1))], 1), wp.vec4)
        records.weight = self._array(generator.uniform(0.1, 1.0, slots), float)
        records.normal = self._array(away.reshape(-1, 3), wp.vec3)
        records.slide = self._array(generator.normal(0.0, 3.0e-4, (slots, 3)), wp.vec3)
        for name in ("offset", "point", "point_vel"):
            setattr(records, name, wp.zeros(slots, dtype=wp.vec3, device=self.device))
        return records

    def plain(self, elapsed: float) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """Return loads and which worlds' links are too close to the wall, by the plain kernel."""
        loads, near = LinkLoads(), wp.zeros(WORLDS, dtype=int, device=self.device)
        for name in ("ll", "la", "aa"):
            setattr(loads, name, wp.full((LINKS, WORLDS), 7.0, dtype=wp.mat33, device=self.device))
        loads.wrench = wp.zeros((LINKS, WORLDS), dtype=wp.spatial_vector, device=self.device)
        inputs = [*self.inputs, elapsed, 0.001]
        wp.launch(load_contacts, (LINKS, WORLDS), inputs=inputs, outputs=[loads, near], device=self.device)
        return {name: getattr(loads, name).numpy() for name in ("ll", "la", "aa", "wrench")}, near.numpy()

    def by_block(self, elapsed: float, worlds: int = WORLDS) -> tuple[LoadRows, np.ndarray]:
        """Return rows of loads and which links are too close to the wall, of the first worlds, by a block a world."""
        rows, near = LoadRows(), wp.zeros(WORLDS, dtype=int, device=self.device)
        rows.fours = wp.full(WORLDS * LINKS * FOURS, np.nan, dtype=wp.vec4, device=self.device)
        rows.loaded = wp.full(WORLDS * LINKS, 7, dtype=int, device=self.device)
        threads, group = (1, 1) if self.device == "cpu" else (THREADS, GROUP)
        motions = wp.zeros(WORLDS * LINKS, dtype=MovingLink, device=self.device)
        inputs, outputs = [*self.inputs, elapsed, 0.001, threads, group], [motions, rows, near]
        launched = {"inputs": inputs, "outputs": outputs, "device": self.device, "block_dim": threads}
        wp.launch(load_contacts_by_block, (worlds, threads), **launched)
        return rows, near.numpy()


@pytest.mark.parametrize("device", ["cpu", CUDA])
def test_a_block_sums_up_loads_as_the_plain_kernel_does(device: str) -> None:
    """At the start of a step, when points of the wall are looked up, and later, when they are read.

    Ways along the wall of 0.3 mm are differences of places, and forces around a link cancel: both magnify rounding.
    """
    contacts = Contacts(device)
    for elapsed in (0.0, 0.003):
        rows, near = contacts.by_block(elapsed)
        points = contacts.records.point.numpy()
        expected, expected_near = contacts.plain(elapsed)
        np.testing.assert_allclose(contacts.records.point.numpy(), points, rtol=0.0, atol=1.0e-7)
        np.testing.assert_array_equal(near, expected_near)
        found = read_rows(rows, WORLDS)
        for name, values in expected.items():
            of_world = np.abs(values).reshape(LINKS, WORLDS, -1).max(axis=(0, 2))
            assert (of_world > 0.0).tolist() == [True, True, True, True, False], name
            error = np.abs(found[name] - values).reshape(LINKS, WORLDS, -1).max(axis=(0, 2))
            assert (error <= 1.0e-4 * of_world).all(), (name, elapsed, error, of_world)


@pytest.mark.parametrize("device", ["cpu", CUDA])
def test_sums_are_the_same_in_every_run_and_for_any_number_of_worlds(device: str) -> None:
    contacts = Contacts(device)
    first, again, alone = (contacts.by_block(0.0, worlds)[0].fours.numpy() for worlds in (WORLDS, WORLDS, 1))
    np.testing.assert_array_equal(again, first)
    np.testing.assert_array_equal(alone[: LINKS * FOURS], first[: LINKS * FOURS])
    assert np.isfinite(alone).any() and np.isnan(alone[LINKS * FOURS :]).all()
