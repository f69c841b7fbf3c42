# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The elastic rod of the fidelity table's references, against textbook cases."""

from __future__ import annotations

import math

import numpy as np
import pytest

from arcgym.benchmarks.fidelity.rod import Rod
from arcgym.benchmarks.fidelity.rod_push import PushSettings, RodPush
from arcgym.benchmarks.fidelity.rod_surface import GridSurface

LONG = 0.4
"""Length of the test tubes [m]."""


def straight_tube(radius: float) -> GridSurface:
    z, angle = np.meshgrid(np.linspace(0.0, LONG, 41), np.arange(24) * math.pi / 12.0, indexing="ij")
    return GridSurface(np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1))


def rod_of(length: float, nodes: int, rigidity: float) -> Rod:
    return Rod(np.full(nodes - 1, length / (nodes - 1)), np.full(nodes - 2, rigidity))


def loaded_end(rod: Rod, force: np.ndarray) -> np.ndarray:
    """Where the end of a rod clamped along Z settles under a dead load, by Newton's method."""
    x = np.zeros((len(rod.length) + 1, 3))
    x[1:, 2] = np.cumsum(rod.length)
    for step in np.linspace(0.1, 1.0, 10):
        for _ in range(30):
            gradient, hessian = rod.slope(x)
            gradient[-1] -= step * force
            if np.abs(gradient[2:]).max() < 1.0e-8:
                break
            x[2:] -= np.linalg.solve(hessian[6:, 6:], gradient[2:].ravel()).reshape(-1, 3)
    return x[-1]


@pytest.mark.parametrize(("load", "deflection"), [(1.0, 0.3017), (4.0, 0.6700)])
def test_a_cantilever_is_the_elastica_of_the_tables(load: float, deflection: float) -> None:
    """Mattiasson 1981. The clamp is between the first two nodes, half an edge before the second."""
    edge = 1.0 / 59.5
    rod = Rod(np.full(60, edge), np.ones(59), 1.0e5)
    assert loaded_end(rod, np.array([load, 0.0, 0.0]))[0] == pytest.approx(deflection, rel=0.005)


def test_slopes_of_the_energy() -> None:
    rod = Rod(np.array([0.005, 0.006, 0.004]), np.array([0.02, 0.01]), 100.0)
    x = np.array([[0.0, 0.0, 0.0], [0.001, 0.0, 0.005], [0.001, 0.002, 0.010], [0.0, 0.003, 0.013]])
    gradient, hessian = rod.slope(x)
    for k in range(12):
        move = 1.0e-8 * np.eye(12)[k].reshape(4, 3)
        assert (rod.energy(x + move) - rod.energy(x - move)) / 2.0e-8 == pytest.approx(gradient.ravel()[k], rel=1e-5)
        turn = (rod.slope(x + move)[0] - rod.slope(x - move)[0]).ravel() / 2.0e-8
        assert turn == pytest.approx(hessian[:, k], rel=1e-5, abs=1e-6 * np.abs(hessian).max())


def test_distance_from_a_cylinder_and_its_curvature() -> None:
    # 12 mm from the axis of a cylinder of 20 mm: 8 mm off, and the distance curves around as -1 / 12 mm.
    near = straight_tube(0.02).project(np.array([[0.012, 0.0, 0.2]]), 0.01)
    assert near.size[0] == pytest.approx(0.008, rel=1e-3)
    assert near.normal[0] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-4)
    assert near.turn[0, 1, 1] == pytest.approx(-1.0 / 0.012, rel=0.01)


def pushed(surface: GridSurface, rigidity: float, friction: float, depth: float, load: float = 0.0) -> RodPush:
    rod = rod_of(depth + 0.05, round((depth + 0.05) / 0.005) + 1, rigidity)
    settings = PushSettings(friction=friction, increment=1.0e-3)
    push = RodPush(rod, np.full(len(rod.length) + 1, 0.006), 0.0, surface, settings, load=load)
    push.place(0.03)
    return push


def ring_tube(radius: float, turn: float, start: float = 0.05) -> tuple[GridSurface, float]:
    """A tube of 8 mm that bends by an angle after a straight start, and the arc length of the bend's end."""
    s, angle = np.meshgrid(np.linspace(0.0, 0.3, 121), np.arange(24) * math.pi / 12.0, indexing="ij")
    bent = np.clip((s - start) / radius, 0.0, turn)
    rest = np.maximum(s - start - turn * radius, 0.0)
    center = np.stack(
        [
            0.0 * s,
            radius * (1.0 - np.cos(bent)) + rest * np.sin(bent),
            np.minimum(s, start) + radius * np.sin(bent) + rest * np.cos(bent),
        ],
        axis=-1,
    )
    across = np.stack([np.cos(angle), np.sin(angle) * np.cos(bent), -np.sin(angle) * np.sin(bent)], axis=-1)
    return GridSurface(center + 0.008 * across), start + turn * radius


def test_a_frictionless_bend_takes_the_energy_of_the_curvature() -> None:
    """Feeding a rod into an arc of radius R takes EI / 2 R^2; with 2 mm of play, R is 80 mm give or take 2 mm.

    The start is long enough that the rod is straight where its guide ends; a bent guide would take work, too."""
    push = pushed(ring_tube(0.08, 1.4, 0.12)[0], 0.025, 0.0, 0.21)
    path = push.push(0.21)
    work = np.trapezoid(path.force, path.inserted)
    in_contact = 0.5 * (push.normal_force**2).sum() / push.settings.stiffness
    assert work == pytest.approx(push.rod.energy(push.x) + in_contact, rel=0.02)
    force, inserted = np.array(path.force), np.array(path.inserted)
    assert force[inserted > 0.17].mean() == pytest.approx(0.025 / (2.0 * 0.08**2), rel=0.06)


def test_friction_grows_around_a_bend_as_euler_and_eytelwein_say() -> None:
    """Pushing a limp rod against a load on its end takes e^(mu theta R_s / R) of the load.

    It lies on the outer side, where friction on the surface, at 88 mm, has a longer lever than the axis, at 82 mm.
    """
    surface, end = ring_tube(0.08, 0.8)
    plain, rubbed = (pushed(surface, 2.0e-3, mu, end + 0.02, load=2.0).push(end + 0.02).force for mu in (0.0, 0.2))
    gain = np.log(np.mean(rubbed[-5:]) / np.mean(plain[-5:]))
    assert gain == pytest.approx(0.2 * 0.8 * 88.0 / 82.0, rel=0.10)
