# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Law of one contact with k = 1000 N/m and a hardening depth of 2 mm, and its load on a link in a step of 2 ms."""

import numpy as np
import pytest

from arcgym.sim.contact.contact_kernels import ContactLaw, normal_force
from arcgym.sim.contact.link_load_kernels import contact_push, load_of

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import warp as wp

DT = 0.002


def law(relief: float = 0.0) -> ContactLaw:
    out = ContactLaw()
    out.relief = relief
    out.stiffness, out.hardening, out.search_gap, out.slip_velocity, out.static_friction = (
        1000.0,
        0.002,
        0.001,
        0.001,
        1.0,
    )
    return out


@wp.kernel
def push(law: ContactLaw, depth: float, out: wp.array(dtype=wp.vec2)):
    out[0] = normal_force(law, depth)


def pushed(depth: float) -> np.ndarray:
    """Force [N] and stiffness [N/m] at a depth [m]."""
    out = wp.zeros(1, dtype=wp.vec2, device="cpu")
    wp.launch(push, 1, [law(), depth], [out], device="cpu")
    return out.numpy()[0]


@pytest.mark.parametrize(
    ("depth", "times"),
    [(0.001, 1.25), (0.002, 2.0), (0.003, 3.25), (0.004, 1.0 + 4.0 + 8.0 * 0.25), (0.006, 28.0), (0.007, 28.0)],
)
def test_a_contact_hardens_with_depth(depth: float, times: float) -> None:
    assert pushed(depth)[0] == pytest.approx(1000.0 * depth * times, rel=1e-5)


@pytest.mark.parametrize("depth", [0.001, 0.0025, 0.004, 0.0055, 0.0065])
def test_its_stiffness_is_the_slope_of_its_force(depth: float) -> None:
    slope = (pushed(depth + 1e-5)[0] - pushed(depth - 1e-5)[0]) / 2e-5
    assert pushed(depth)[1] == pytest.approx(slope, rel=1e-3)


@wp.kernel
def load(law: ContactLaw, gap: float, velocity: float, out: wp.array(dtype=wp.vec2)):
    n = wp.vec3(1.0, 0.0, 0.0)
    body = load_of(contact_push(law, 1.0, 0.0, gap, n, velocity * n, wp.vec3(0.0), wp.vec3(0.0), 0.002))
    out[0] = wp.vec2(body.force[0], body.ll[0, 0])


@pytest.mark.parametrize(
    ("gap", "velocity", "force", "mass"),
    [
        (-0.001, 0.0, 1.25, DT * DT * 1250.0),  # rests on the wall
        (-0.001, -1.0, 0.0, DT * DT * 1250.0),  # leaves it by 1 mm in this step, unless something presses it back
        (0.0005, 0.0, 0.0, DT * DT * 500.0),  # not there yet
        (0.0005, -1.0, 0.0, DT * DT * 500.0),
        (0.0015, 0.0, 0.0, 0.0),  # beyond the search gap
    ],
)
def test_a_wall_that_is_near_resists_acceleration_alone(gap: float, velocity: float, force: float, mass: float) -> None:
    out = wp.zeros(1, dtype=wp.vec2, device="cpu")
    wp.launch(load, 1, [law(), gap, velocity], [out], device="cpu")
    assert out.numpy()[0] == pytest.approx([force, mass], rel=1e-3)


@pytest.mark.parametrize(
    ("relief", "gap", "velocity", "force"),
    [
        (0.0, -0.001, 0.5, 4.0),  # 2 mm deep at the end of the step
        (1.0, -0.001, 0.5, 1.25),  # 1 mm at its beginning
        (0.5, -0.001, 0.5, 1.5 * (1.0 + 0.75**2)),  # half way
        (1.0, -0.001, 0.01, 1.01 * (1.0 + 0.505**2)),  # half way as well, for it is slow: 20 um in the step
        (1.0, 0.0005, 0.5, 0.0),  # arrives in this step
    ],
)
def test_damping_of_the_step_is_taken_off_the_force_alone(
    relief: float, gap: float, velocity: float, force: float
) -> None:
    out, kept = (wp.zeros(1, dtype=wp.vec2, device="cpu") for _ in range(2))
    wp.launch(load, 1, [law(relief), gap, velocity], [out], device="cpu")
    wp.launch(load, 1, [law(), gap, velocity], [kept], device="cpu")
    assert out.numpy()[0, 0] == pytest.approx(force, rel=1e-3) and out.numpy()[0, 1] == kept.numpy()[0, 1]


@pytest.mark.parametrize(
    ("gap", "velocity", "damper"),
    [
        (-0.001, 0.4, 0.0),  # 1.8 mm deep at the end of the step: no deeper than the hardening depth
        (-0.002, 0.5, 50.0),  # 3 mm: half way to twice that
        (-0.005, 0.5, 100.0),  # 6 mm: in full
        (-0.005, -0.5, 0.0),  # goes back
    ],
)
def test_only_deep_contacts_are_damped_further_and_only_on_their_way_in(
    gap: float, velocity: float, damper: float
) -> None:
    out, kept = (wp.zeros(1, dtype=wp.vec2, device="cpu") for _ in range(2))
    damped = law()
    damped.deep_damping = 100.0
    wp.launch(load, 1, [damped, gap, velocity], [out], device="cpu")
    wp.launch(load, 1, [law(), gap, velocity], [kept], device="cpu")
    more = out.numpy()[0] - kept.numpy()[0]
    assert more == pytest.approx([damper * velocity, DT * damper], rel=1e-3, abs=1e-6)
