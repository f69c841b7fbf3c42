# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Room for a stiff head, in tubes where it can be worked out."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from tiny import tiny_colon_stage

from arcgym.anatomy.measures import inner_faces
from arcgym.anatomy.validation import passage
from arcgym.anatomy.validation.distance_kernels import signed_distances
from arcgym.anatomy.validation.passage import HEAD_LENGTH, HEAD_RADIUS, find_passage, head_passage

HALF = 0.5 * HEAD_LENGTH - HEAD_RADIUS
"""Half the length of the head's straight axis: 14.9 mm."""


def test_straight_tube_takes_a_head_as_thick_as_itself() -> None:
    arc = np.linspace(0.0, 0.2, 101)
    line = np.stack([0.0 * arc, 0.0 * arc, arc], 1)
    found = find_passage(lambda p: 0.0068 - np.linalg.norm(p[..., :2], axis=-1), line, arc, HEAD_RADIUS, HEAD_LENGTH)
    assert found.least == pytest.approx(0.0068, abs=1e-6)


def test_bend_takes_a_thinner_head_than_its_least_radius() -> None:
    """A chord fits best with its ends as far outside of the tube's axis as its middle is inside: h^2 / 4 R."""
    bend, radius = 0.020, 0.009
    angle = np.linspace(0.0, np.pi, 200)
    line = bend * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], 1)

    def clearance(points: np.ndarray) -> np.ndarray:
        return radius - np.hypot(np.hypot(points[..., 0], points[..., 1]) - bend, points[..., 2])

    found = find_passage(clearance, line, bend * angle, HEAD_RADIUS, HEAD_LENGTH)
    assert np.median(found.room) == pytest.approx(radius - HALF**2 / (4 * bend), abs=2e-4)
    assert found.least < HEAD_RADIUS


def test_heads_lie_along_the_way_and_do_not_jump() -> None:
    stage = tiny_colon_stage(length=0.2, radius=0.012, bend=1.5)
    found = head_passage(stage)
    assert found.least > HEAD_RADIUS
    assert (found.axis[1:] * found.axis[:-1]).sum(1).min() > 0.8
    assert np.linalg.norm(np.diff(found.middle, axis=0), axis=1).max() < 0.012


def test_ring_that_is_drawn_in_stops_the_head() -> None:
    stage = tiny_colon_stage(length=0.2, radius=0.012, rings=41)
    waist = stage.wall.ring == 20
    stage.wall.points[waist, :2] *= 0.4
    found = head_passage(stage)
    assert found.least == pytest.approx(0.0048 * np.cos(np.pi / 8), abs=2e-4)
    assert abs(found.tightest - 0.1) < HALF + 0.004


def test_the_fast_way_gives_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    stage = tiny_colon_stage(length=0.2, radius=0.012, rings=41, bend=1.5)
    waist = stage.wall.ring == 20
    middle = stage.wall.points[waist].mean(0)
    stage.wall.points[waist] = middle + 0.5 * (stage.wall.points[waist] - middle)
    fast = head_passage(stage)
    monkeypatch.setattr(passage._Heads, "_sure_to_lose", lambda self, index, room: np.zeros(len(index), bool))
    plain = head_passage(stage)
    for name in ("room", "middle", "axis"):
        assert (getattr(fast, name) == getattr(plain, name)).all()
    assert fast.least < HEAD_RADIUS


def test_the_search_ends_where_what_is_asked_for_is_there() -> None:
    """Of a bend of 20 mm a tube of 9 mm takes 6.2 mm: the search for 6.6 goes on to its end; 4 mm lie at once."""
    bend, radius = 0.020, 0.009
    angle = np.linspace(0.0, np.pi, 200)
    line = bend * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], 1)
    asked = []

    def clearance(points: np.ndarray) -> np.ndarray:
        asked.append(len(points))
        return radius - np.hypot(np.hypot(points[..., 0], points[..., 1]) - bend, points[..., 2])

    short = find_passage(clearance, line, bend * angle, HEAD_RADIUS, HEAD_LENGTH, until=0.004)
    assert short.least >= 0.004 and len(asked) == 1
    assert find_passage(clearance, line, bend * angle, HEAD_RADIUS, HEAD_LENGTH).least > short.least
    assert len(asked) > 100


def test_least_distance_is_that_of_all_points() -> None:
    """In a bent tube and outside of it, also near its open ends; the shortcut finds the same to the bit."""
    stage = tiny_colon_stage(length=0.3, radius=0.012, bend=1.5)
    line, points, faces = stage.centerline.points, stage.wall.points, inner_faces(stage.wall.tets, stage.wall.layer)
    surface = passage._WallDistance(points.astype(float), faces, line[[0, -1]])
    rng = np.random.default_rng(0)
    start = line[rng.integers(len(line), size=(400, 1, 1))] + rng.normal(0.0, 0.003, (400, 3, 1, 3))
    groups = (start + rng.normal(0.0, 0.002, (400, 3, 1, 3)) * np.arange(7)[:, None]).astype(np.float32)
    places = wp.array(groups.reshape(-1, 3), dtype=wp.vec3, device="cpu")
    out = wp.zeros(len(places), dtype=float, device="cpu")
    wp.launch(signed_distances, len(out), inputs=[surface._mesh.id, places], outputs=[out], device="cpu")
    expected = out.numpy().reshape(400, -1).min(1)
    assert (expected > 0.0).any() and (expected < 0.0).any()
    assert np.array_equal(surface.least(groups), expected.astype(float))
