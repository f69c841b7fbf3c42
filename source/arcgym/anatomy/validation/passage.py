# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Room for a stiff head along a lumen: the thickest one of a length that can lie, and be moved on, at every place.

A least radius says nothing about bends: in a bend of 15 mm radius a straight head of 43 mm needs a lumen of 10 mm
radius to be 6.6 mm thick itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.ndimage import binary_dilation, label, minimum

from arcgym.anatomy.measures import inner_faces
from arcgym.anatomy.stage.types import Centerline, ColonStage, ContactSurface, WallMesh

HEAD_RADIUS = 0.0066
"""Radius of the shipped scopes' heads [m]."""

HEAD_LENGTH = 0.043
"""Length of that head with its round ends [m]."""

Clearance = Callable[[np.ndarray], np.ndarray]
"""Function that returns the distance to the wall [m], negative outside the lumen, of points (..., 3)."""

Least = Callable[[np.ndarray], np.ndarray]
"""Function that returns the least of these distances [m], shape (n,), of groups of chains of points (n, c, m, 3)."""

Touched = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Function that returns which groups of points (n, m, 3) come within a distance (n,) [m] of the wall, shape (n,)."""

_STATION = 0.004
"""Distance of the places at which the head is laid [m]."""

_BLIND = 0.014
"""Distance of the blind end from the head's axis at the last place [m]."""

_BEADS = 7
"""Points along the head's axis at which the distance to the wall is taken."""

_ATTEMPTS = 8
"""How often heads that do not pass are laid anew."""

_AROUND = 6
"""Places on either side that are laid anew with one that does not pass."""

_ROUNDS = 40, 120
"""Random moves of a head: alone, and between its neighbors."""

_MOVES = ((0.004, 0.30), (0.002, 0.15), (0.001, 0.06), (0.0004, 0.03))
"""Size of the moves [m] and turns [rad], each in a quarter of the rounds."""

_ENOUGH = 0.0005
"""Room beyond what is asked for from which a place is not improved any more [m]."""

_CENTERED = 1.8, 1.0
"""Room that is looked for with each head alone, over what is enough, in turn."""

_TOGETHER = 0.3
"""Room that a head gives up so as not to be off its neighbors' mean, over how far it would be."""

_ALONG = 0.95, 0.8, 0.6, 0.3
"""Least cosine between a head alone and the course, in turn; between its neighbors it is the last."""


@dataclass(frozen=True)
class Passage:
    """How thick a head of a length may be."""

    arc: np.ndarray
    """Arc length of the middle of the head [m], shape (n,)."""
    room: np.ndarray
    """Largest radius of the head there that was found [m], at most 0.5 mm above what is asked for, shape (n,)."""
    middle: np.ndarray
    """Middle of the head there [m], shape (n, 3)."""
    axis: np.ndarray
    """Unit vector along it, shape (n, 3)."""

    @property
    def least(self) -> float:
        """Least room along the lumen [m]."""
        return float(self.room.min())

    @property
    def tightest(self) -> float:
        """Arc length of the least room [m]."""
        return float(self.arc[self.room.argmin()])


def head_passage(stage: ColonStage, radius: float = HEAD_RADIUS, length: float = HEAD_LENGTH) -> Passage:
    """Return the room for a stiff head in a stage at rest, from the anal verge to the dome of the cecum.

    What counts is the contact surface; where a stage has none, the wall's inner layer.

    Args:
        stage: The colon.
        radius: Radius of the head [m].
        length: Its length with both round ends [m].
    """
    line = stage.centerline
    if stage.contact is not None:
        return contact_passage(stage.contact, line, radius, length)
    return wall_passage(stage.wall, line.points.astype(float), line.arc.astype(float), radius, length)


def contact_passage(
    contact: ContactSurface,
    line: Centerline,
    radius: float = HEAD_RADIUS,
    length: float = HEAD_LENGTH,
    until: float = np.inf,
) -> Passage:
    """Return the room for a stiff head inside of a contact surface at rest.

    Args:
        contact: The surface.
        line: The centerline in it.
        radius: Radius of the head [m].
        length: Its length with both round ends [m].
        until: Room everywhere at which the search ends [m].
    """
    points, arc = line.points.astype(float), line.arc.astype(float)
    surface = _WallDistance(contact.points.astype(float), contact.faces(), points[[0, -1]])
    return _find(surface.least, points, arc, radius, length, surface.touched, until)


def wall_passage(
    wall: WallMesh,
    points: np.ndarray,
    arc: np.ndarray,
    radius: float = HEAD_RADIUS,
    length: float = HEAD_LENGTH,
    until: float = np.inf,
) -> Passage:
    """Return the room for a stiff head inside of a wall at rest.

    Args:
        wall: The wall.
        points: Centerline [m], shape (n, 3).
        arc: Its arc length [m], shape (n,).
        radius: Radius of the head [m].
        length: Its length with both round ends [m].
        until: Room everywhere at which the search ends [m].
    """
    surface = _WallDistance(wall.points.astype(float), inner_faces(wall.tets, wall.layer), points[[0, -1]])
    return _find(surface.least, points, arc, radius, length, surface.touched, until)


class _WallDistance:
    """Signed distance to a triangulated wall; the side is by the winding number, which sharp folds do not mislead."""

    def __init__(self, points: np.ndarray, faces: np.ndarray, ends: np.ndarray) -> None:
        """Prepare searches.

        Args:
            points: Vertices [m], shape (V, 3).
            faces: Triangles, shape (F, 3).
            ends: Places of the wall's two openings, or of what may be open [m], shape (2, 3).
        """
        from arcgym.utils import warp_setup  # noqa: F401  isort: skip
        import warp as wp

        vertices = wp.array(points, dtype=wp.vec3, device="cpu")
        indices = wp.array(faces.ravel().astype(np.int32), dtype=int, device="cpu")
        self._mesh = wp.Mesh(vertices, indices, support_winding_number=True)
        self._ends = wp.array(ends, dtype=wp.vec3, device="cpu")
        self._searches: dict[tuple[str, int, int], _Search] = {}

    def least(self, points: np.ndarray) -> np.ndarray:
        """Return the least distance to the wall [m], negative outside the lumen, of groups of chains of points.

        Args:
            points: Positions [m], shape (n, chains, points, 3).
        """
        from arcgym.anatomy.validation.distance_kernels import least_signed_distances

        count, chains, length = points.shape[:3]
        if ("least", chains, length) not in self._searches:
            search = _Search(least_signed_distances, chains * length, [self._mesh.id], [length, self._ends], float)
            self._searches["least", chains, length] = search
        search = self._searches["least", chains, length]
        return search(points.reshape(count, chains * length, 3)).astype(float)

    def touched(self, points: np.ndarray, limit: np.ndarray) -> np.ndarray:
        """Return whether any point of a group is within a distance of the wall [m], shape (n,), of points (n, m, 3)."""
        from arcgym.anatomy.validation.distance_kernels import any_nearer

        length = points.shape[1]
        if ("touched", 1, length) not in self._searches:
            self._searches["touched", 1, length] = _Search(any_nearer, length, [self._mesh.id], [], bool, limited=True)
        return self._searches["touched", 1, length](points, limit)


class _Search:
    """A kernel over groups of points, launched again and again on the same arrays: most launches are small."""

    def __init__(
        self, kernel: Any, length: int, before: list[Any], after: list[Any], result: type, limited: bool = False
    ) -> None:
        """Prepare launches.

        Args:
            kernel: Takes ``before``, points (n, length), limits (n,) if there are any, ``after``, and an output (n,).
            length: Points of a group.
            before: First inputs.
            after: Last inputs.
            result: Type of the output.
            limited: Whether each group has a limit.
        """
        self._kernel, self._length, self._before, self._after = kernel, length, before, after
        self._result, self._limited, self._size = result, limited, 0

    def __call__(self, points: np.ndarray, limit: np.ndarray | None = None) -> np.ndarray:
        """Return the output for groups of points, shape (n,), of points (n, length, 3) and limits (n,)."""
        count = len(points)
        if count > self._size:
            self._prepare(2 * count)
        self._points[:count] = points
        if limit is not None:
            self._limits[:count] = limit
        self._launch.set_dim(count)
        self._launch.launch()
        return self._out[:count].copy()

    def _prepare(self, size: int) -> None:
        import warp as wp

        points = wp.zeros((size, self._length), dtype=wp.vec3, device="cpu")
        limits, out = wp.zeros(size, dtype=float, device="cpu"), wp.zeros(size, dtype=self._result, device="cpu")
        inputs = [*self._before, points, *([limits] if self._limited else []), *self._after]
        self._launch = wp.launch(self._kernel, size, inputs=inputs, outputs=[out], device="cpu", record_cmd=True)
        self._points, self._limits, self._out, self._size = points.numpy(), limits.numpy(), out.numpy(), size
        self._kept = points, limits, out


class _Heads:
    """Heads at all places, each between its neighbors."""

    def __init__(self, least: Least, points: np.ndarray, arc: np.ndarray, half: float, touched: Touched | None) -> None:
        self.least, self.half, self.touched = least, half, touched
        self.beads = half * np.linspace(-1.0, 1.0, _BEADS)[:, None]
        first = arc[0] + half
        self.arc = np.arange(first, max(arc[-1] - half - _BLIND, first + _STATION), _STATION)
        at = lambda s: np.stack([np.interp(s, arc, points[:, k]) for k in range(3)], 1)  # noqa: E731
        self.tangent = _unit(at(self.arc + half) - at(self.arc - half))
        self.course = 0.25 * (at(self.arc + half) + 2.0 * at(self.arc) + at(self.arc - half))
        self.middle, self.axis = self.course.copy(), self.tangent.copy()
        self.room = self.worst(np.arange(len(self.arc)))

    def worst(self, index: np.ndarray) -> np.ndarray:
        """Return the least distance to the wall [m] of heads at some places, and half-way to both neighbors."""
        return self.least(self._beads(*self._poses(index)))

    def _poses(self, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return middles and axes of heads at some places, and half-way to both neighbors, shape (n, 3, 3) each."""
        middle, axis = self.middle[index], self.axis[index]
        middles, axes = np.empty((2, len(index), 3, 3))
        middles[:, 0], axes[:, 0] = middle, axis
        for side, other in ((1, np.maximum(index - 1, 0)), (2, np.minimum(index + 1, len(self.arc) - 1))):
            middles[:, side] = 0.5 * (middle + self.middle[other])
            axes[:, side] = _unit(axis + self.axis[other])
        return middles, axes

    def _beads(self, middle: np.ndarray, axis: np.ndarray) -> np.ndarray:
        """Return points along the axes of heads in some poses (n, poses, 3) [m], shape (n, poses, beads, 3)."""
        return middle[:, :, None] + self.beads * axis[:, :, None]

    def _sure_to_lose(self, index: np.ndarray, room: np.ndarray) -> np.ndarray:
        """Return which heads have no more than some room [m], as far as that can be told without the wall's side."""
        if self.touched is None or not len(index):
            return np.zeros(len(index), bool)
        return self.touched(self._beads(*self._poses(index)).reshape(len(index), -1, 3), room)

    def search(self, rng: np.random.Generator, enough: float, until: float) -> None:
        """Lay heads anew wherever there is less room than ``enough`` [m]: each alone first, then with its neighbors.

        What a place has is never lost again, so that the search may end where all have ``until`` [m].
        """
        for attempt in range(_ATTEMPTS):
            poor = self.room < enough
            if self.room.min() >= until:
                return
            stretch, count = label(binary_dilation(poor, iterations=_AROUND))
            before = self.middle.copy(), self.axis.copy(), self.room.copy()
            index = np.flatnonzero(stretch)
            if attempt:
                self.middle[index], self.axis[index] = self.course[index], self.tangent[index]
            self._spread_out(index, rng, _CENTERED[attempt % 2] * enough, _ALONG[attempt % len(_ALONG)])
            self._fit_in(index, rng, enough)
            least = [minimum(room, stretch, np.arange(1, count + 1)) for room in (before[2], self.room)]
            failed = np.isin(stretch, 1 + np.flatnonzero(np.asarray(least[1]) <= np.asarray(least[0])))
            for now, then in zip((self.middle, self.axis, self.room), before, strict=True):
                now[failed] = then[failed]

    def _spread_out(self, index: np.ndarray, rng: np.random.Generator, enough: float, along: float) -> None:
        """Move each head to where it has room, up to ``enough`` [m], but not far from where its neighbors went."""
        own = np.full(len(self.arc), np.inf)
        own[index] = self.least(self._beads(self.middle[index, None], self.axis[index, None]))
        for k in range(_ROUNDS[0]):
            for parity in (0, 1):
                chosen = index[(index % 2 == parity) & (own[index] < enough)]
                if not len(chosen):
                    continue
                middle, axis = self._moved(chosen, rng, *_MOVES[len(_MOVES) * k // _ROUNDS[0]], along)
                room = self.least(self._beads(middle[:, None], axis[:, None]))
                before = self._astray(chosen, self.middle[chosen], self.axis[chosen])
                gain = np.minimum(room, enough) - np.minimum(own[chosen], enough)
                better = gain > _TOGETHER * (self._astray(chosen, middle, axis) - before)
                chosen = chosen[better]
                self.middle[chosen], self.axis[chosen], own[chosen] = middle[better], axis[better], room[better]
        self.room[index] = self.worst(index)

    def _astray(self, index: np.ndarray, middle: np.ndarray, axis: np.ndarray) -> np.ndarray:
        """Return how far heads are off the mean of their neighbors, both taken from the course [m], shape (n,)."""
        sides = np.maximum(index - 1, 0), np.minimum(index + 1, len(self.arc) - 1)
        shift = sum(0.5 * (self.middle[side] - self.course[side]) for side in sides)
        turn = sum(0.5 * (self.axis[side] - self.tangent[side]) for side in sides)
        aside = np.linalg.norm(middle - self.course[index] - shift, axis=1)
        return aside + self.half * np.linalg.norm(axis - self.tangent[index] - turn, axis=1)

    def _fit_in(self, index: np.ndarray, rng: np.random.Generator, enough: float) -> None:
        """Move heads where they, or the way to their neighbors, have less room than ``enough`` [m]."""
        for k in range(_ROUNDS[1]):
            poor = index[self.room[index] < enough]
            if not len(poor):
                break
            for parity in (0, 1):
                self._improve(poor[poor % 2 == parity], rng, *_MOVES[len(_MOVES) * k // _ROUNDS[1]])

    def _improve(self, index: np.ndarray, rng: np.random.Generator, move: float, turn: float) -> None:
        """Try a random move of heads of which no two are neighbors, and keep what gives more room."""
        before = self.middle[index], self.axis[index], self.room[index]
        self.middle[index], self.axis[index] = self._moved(index, rng, move, turn)
        worse = self._sure_to_lose(index, before[2])
        worse[~worse] = self.worst(index[~worse]) <= before[2][~worse]
        self.middle[index[worse]], self.axis[index[worse]] = before[0][worse], before[1][worse]
        near = np.zeros(len(self.arc) + 2, bool)
        for step in (0, 1, 2):
            near[index[~worse] + step] = True
        near = np.flatnonzero(near[1:-1])
        self.room[near] = self.worst(near)

    def _moved(
        self, index: np.ndarray, rng: np.random.Generator, move: float, turn: float, least: float = _ALONG[-1]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return middles shifted across the course by some way [m] and axes turned by some angle [rad].

        Axes keep a least cosine to the course.
        """
        shift = rng.normal(0.0, move, (len(index), 3))
        shift -= (shift * self.tangent[index]).sum(1, keepdims=True) * self.tangent[index]
        axis = _unit(self.axis[index] + rng.normal(0.0, turn, (len(index), 3)))
        along = (axis * self.tangent[index]).sum(1, keepdims=True) > least
        return self.middle[index] + shift, np.where(along, axis, self.axis[index])


def find_passage(
    clearance: Clearance,
    points: np.ndarray,
    arc: np.ndarray,
    radius: float,
    length: float,
    until: float = np.inf,
) -> Passage:
    """Lay a head along a line and move it about until it has most room, seeded so that results repeat.

    Args:
        clearance: Distance to the wall.
        points: Centerline [m], shape (n, 3).
        arc: Its arc length [m], shape (n,).
        radius: Radius of the head [m].
        length: Its length with both round ends [m].
        until: Room everywhere at which the search ends [m]; else it ends where no place can have more.
    """
    return _find(lambda groups: clearance(groups).min((1, 2)), points, arc, radius, length, None, until)


def _find(
    least: Least,
    points: np.ndarray,
    arc: np.ndarray,
    radius: float,
    length: float,
    touched: Touched | None,
    until: float,
) -> Passage:
    """Do as :func:`find_passage`; ``touched`` is a faster way to tell that a head has no more than some room."""
    heads = _Heads(least, points, arc, 0.5 * length - radius, touched)
    heads.search(np.random.default_rng(0), radius + _ENOUGH, min(until, radius + _ENOUGH))
    return Passage(heads.arc, np.minimum(heads.room, radius + _ENOUGH), heads.middle, heads.axis)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.sqrt((vectors * vectors).sum(-1, keepdims=True)), 1e-12)
