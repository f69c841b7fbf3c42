# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Which ring of the colon a link is in."""

from __future__ import annotations

import numpy as np
import warp as wp

from arcgym.sim.contact.lumen_kernels import track_rings

# Eight rings up, four across and eight down again, a meter apart: the colon bends back on itself.
CENTERS = [(0, 0, z) for z in range(8)] + [(x, 0, 7) for x in range(1, 5)] + [(5, 0, 7 - z) for z in range(8)]


def track(places: list[tuple[float, float, float]], rings: list[int], shift: int = 2) -> list[int]:
    """Return the rings of one world's links, by their places, after the rings at the last call."""
    poses = np.array([[*place, 0.0, 0.0, 0.0, 1.0] for place in places], np.float32)
    before, ring = (wp.array(np.array([rings]), dtype=int, device="cpu") for _ in range(2))
    inputs = [wp.array(np.array([CENTERS], np.float32), dtype=wp.vec3, device="cpu")]
    inputs += [
        wp.array(poses, dtype=wp.transform, device="cpu"),
        shift,
        wp.ones(1, dtype=wp.bool, device="cpu"),
        before,
    ]
    distance = wp.zeros((1, len(places)), dtype=float, device="cpu")
    wp.launch(track_rings, (1, len(places)), inputs=inputs, outputs=[ring, distance], device="cpu")
    return ring.numpy()[0].tolist()


def test_a_ring_is_followed_from_the_last_one() -> None:
    assert track([(0.0, 0.0, 1.2), (0.0, 0.0, 2.2)], [1, 1]) == [1, 2]


def test_a_ring_beside_which_the_link_lies_is_not_taken_for_its_own() -> None:
    # the second link lies between the legs, 3 m from ring 3 of its own leg and 2 m from ring 16 of the other
    assert track([(0.0, 0.0, 2.0), (3.0, 0.0, 3.0)], [2, 3]) == [2, 3]


def test_a_link_that_lost_its_ring_is_found_again_from_its_neighbor() -> None:
    # at ring 2, but held to be in ring 18 of the other leg: of the rings 16 to 19 there, 17 is nearest
    assert track([(0.0, 0.0, 2.0)], [18]) == [17]
    assert track([(0.0, 0.0, 1.0), (0.0, 0.0, 2.0)], [1, 18]) == [1, 2]
