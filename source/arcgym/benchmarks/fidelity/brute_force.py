# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contacts of links and wall found by looking at every pair, in double precision and apart from the simulation's code.

P pairs of a segment and a triangle.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp


@dataclass(frozen=True)
class ContactSample:
    """Pairs of a link and a face that touch in a world, found by looking at all pairs; K of them."""

    touching: np.ndarray
    """Link and face of each pair, shape (K, 2)."""
    missed: np.ndarray
    """Whether the simulation has no record of it, bool, shape (K,)."""


def sample_contacts(sim: Any, worlds: Iterable[int] = (0,)) -> list[ContactSample]:
    """Compare the contacts of some worlds, in their present state, with those of all pairs of a link and a face.

    A link touches a face if its surface is nearer than the wall's skin, with the nearest point of its axis on the
    lumen's side of the face. Links whose center is outside the anus are left out: the wall has no outer surface.

    Args:
        sim: The simulation; its contacts are detected anew, which does not change what follows.
        worlds: The worlds.
    """
    sim.contact.detect(sim.nodal_pos, sim.state.body_q)
    sim.contact.measure_surface(sim.nodal_pos)  # of a fine surface, the search moves on what is near links alone
    faces = sim.contact.surface.faces.numpy()
    samples = []
    for world in worlds:
        known = recorded(sim, world)
        pairs = touching(sim, faces, world)
        missed = [pair not in known for pair in pairs]
        samples.append(ContactSample(np.array(pairs, dtype=int).reshape(-1, 2), np.array(missed, dtype=bool)))
    return samples


def recorded(sim: Any, world: int) -> set[tuple[int, int]]:
    """Return link and face of each contact that the simulation has recorded in a world."""
    records = sim.contact.records
    first, count = world * records.capacity, int(wp.to_torch(records.start)[world, -1])
    link, face = (wp.to_torch(array)[first : first + count].tolist() for array in (records.link, records.face))
    return set(zip(link, face, strict=True))


def touching(sim: Any, faces: np.ndarray, world: int) -> list[tuple[int, int]]:
    """Return (link, face) of all that touch in a world.

    Args:
        sim: The simulation.
        faces: Faces of the lumen, normals into the wall, shape (F, 3).
        world: The world.
    """
    start, end = link_axes(sim, world)
    reach = sim.endoscope.stage.link_radius + sim.contact.law.wall_radius
    inside = np.flatnonzero(wp.to_torch(sim.contact.ring_distance)[world].cpu().numpy() < 1.0e9)
    corners = wp.to_torch(sim.contact.points)[:, world].cpu().numpy().astype(float)[faces]
    middle = corners.mean(axis=1)
    size = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    found = []
    for link in inside:
        p, q = (np.broadcast_to(points[link], middle.shape) for points in (start, end))
        near = np.flatnonzero(np.linalg.norm(closest_on_segment(middle, p, q) - middle, axis=1) < reach[link] + size)
        distance, lumen_side = segment_triangle(p[near], q[near], corners[near])
        found += [(int(link), int(face)) for face in near[(distance < reach[link]) & lumen_side]]
    return found


def link_axes(sim: Any, world: int) -> tuple[np.ndarray, np.ndarray]:
    """Return both ends of the links' axes in a world [m], each of shape (L, 3)."""
    from arcgym.utils.math import quat_apply

    data = sim.endoscope.data
    half = data.body_pos_w.new_zeros(sim.endoscope.num_bodies, 3)
    half[:, 2] = half.new_tensor(sim.endoscope.half_length)
    turned = quat_apply(data.body_quat_w[world], half)
    center, axis = (t.cpu().numpy().astype(float) for t in (data.body_pos_w[world], turned))
    return center - axis, center + axis


def segment_triangle(p: np.ndarray, q: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the distance of segments from triangles, and on which side the nearest point of the segment is.

    Ends against the face, the segment against all edges, and zero for a segment that goes through the face: these are
    all places where the distance can be least.

    Args:
        p: One end of each segment [m], shape (P, 3).
        q: The other, shape (P, 3).
        corners: Corners of each triangle, shape (P, 3, 3).

    Returns:
        Distance [m], shape (P,), and whether the nearest point of the segment is on the side that the normal points
        away from; of a segment that goes through the face, its middle.
    """
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    best = np.full(len(p), np.inf)
    nearest, middle = 0.5 * (p + q), 0.5 * (p + q)
    for end in (p, q):
        foot, inside = project(end, corners, normal)
        best, nearest = nearer(best, nearest, np.where(inside, np.linalg.norm(foot - end, axis=1), np.inf), end)
    for k in range(3):
        on_segment, on_edge = closest_of_segments(p, q, corners[:, k], corners[:, (k + 1) % 3])
        best, nearest = nearer(best, nearest, np.linalg.norm(on_segment - on_edge, axis=1), on_segment)
    above, below = (np.einsum("pi,pi->p", normal, end - corners[:, 0]) for end in (p, q))
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = p + (above / (above - below))[:, None] * (q - p)
    through = (above * below < 0.0) & project(crossing, corners, normal)[1]
    best, nearest = np.where(through, 0.0, best), np.where(through[:, None], middle, nearest)
    return best, np.einsum("pi,pi->p", normal, corners[:, 0] - nearest) > 0.0


def nearer(best: np.ndarray, point: np.ndarray, distance: np.ndarray, other: np.ndarray) -> tuple[Any, Any]:
    """Return the smaller distances and the points that belong to them."""
    closer = distance < best
    return np.where(closer, distance, best), np.where(closer[:, None], other, point)


def project(points: np.ndarray, corners: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the feet of points in the planes of triangles, and whether they are inside the triangles."""
    square = np.maximum(np.einsum("pi,pi->p", normal, normal), 1.0e-30)
    height = np.einsum("pi,pi->p", points - corners[:, 0], normal) / square
    foot = points - height[:, None] * normal
    inside = np.ones(len(points), bool)
    for k in range(3):
        edge = corners[:, (k + 1) % 3] - corners[:, k]
        inside &= np.einsum("pi,pi->p", np.cross(edge, foot - corners[:, k]), normal) >= 0.0
    return foot, inside


def closest_on_segment(point: np.ndarray, p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the points of segments nearest to points, shape (P, 3)."""
    along = q - p
    square = np.maximum(np.einsum("pi,pi->p", along, along), 1.0e-30)
    t = np.clip(np.einsum("pi,pi->p", point - p, along) / square, 0.0, 1.0)
    return p + t[:, None] * along


def closest_of_segments(p: np.ndarray, q: np.ndarray, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the nearest points of two segments: of their lines if both lie inside, else of an end and a segment."""
    u, v, w = q - p, b - a, p - a
    uu, uv, vv, uw, vw = (np.einsum("pi,pi->p", x, y) for x, y in ((u, u), (u, v), (v, v), (u, w), (v, w)))
    det = uu * vv - uv * uv
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = (uv * vw - vv * uw) / det, (uu * vw - uv * uw) / det
    inner = (det > 1.0e-12 * uu * vv) & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)
    s, t = np.where(inner, s, 0.0), np.where(inner, t, 0.0)
    first, second = p + s[:, None] * u, a + t[:, None] * v
    best = np.where(inner, np.linalg.norm(first - second, axis=1), np.inf)
    ends = [(end, closest_on_segment(end, a, b)) for end in (p, q)]
    ends += [(closest_on_segment(end, p, q), end) for end in (a, b)]
    for x, y in ends:
        distance = np.linalg.norm(x - y, axis=1)
        second = nearer(best, second, distance, y)[1]
        best, first = nearer(best, first, distance, x)
    return first, second
