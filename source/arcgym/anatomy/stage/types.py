# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A colon as numpy arrays: what a stage file holds and what the simulation, the camera and the tasks read."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.anatomy.segments import SEGMENTS, segment_index
from arcgym.utils.errors import UsageError

TEXTURE_LENGTH = 0.24
"""Length of colon that one repeat of the texture covers [m]."""


class StageError(UsageError):
    """A stage file cannot be used; the message names file, prim and attribute, what was found and how to mend it."""

    def __init__(self, path: str | Path, prim: str, attribute: str, found: str, mend: str) -> None:
        """Build the message from its five parts; an empty prim or attribute is left out."""
        where = "".join([f", prim {prim}" if prim else "", f", attribute '{attribute}'" if attribute else ""])
        super().__init__(f"{path}{where}: {found}. {mend}")


@dataclass(frozen=True)
class WallMesh:
    """Tetrahedral wall on a grid of rings and sectors: vertex ``layer * rings * sectors + ring * sectors + sector``."""

    points: np.ndarray
    """Rest positions [m], shape (V, 3), float32."""
    tets: np.ndarray
    """Vertex indices of each tetrahedron, positive volume, shape (T, 4), int32."""
    anchor: np.ndarray
    """0 free, 1 elastic attachment, 2 fixed, shape (V,), int32."""
    segment: np.ndarray
    """Index into ``SEGMENTS``, shape (V,), int32."""
    ring: np.ndarray
    """Ring number along the centerline, from the anal verge, shape (V,), int32."""
    layer: np.ndarray
    """0 for the lumen side, then outwards, shape (V,), int32."""
    frame_neighbors: np.ndarray
    """Next ring, previous ring, next around, previous around; itself where there is none, shape (V, 4), int32."""
    ring_arc: np.ndarray
    """Arc length of each ring along the centerline at rest [m], shape (R,), float32."""

    @property
    def num_rings(self) -> int:
        """Number of rings R."""
        return len(self.ring_arc)

    @property
    def num_sectors(self) -> int:
        """Number of vertices around one ring of one layer."""
        return int(np.count_nonzero((self.ring == 0) & (self.layer == 0)))


@dataclass(frozen=True)
class VisualMesh:
    """Inner surface as the camera sees it, skinned to the wall's inner layer."""

    points: np.ndarray
    """Rest positions [m], shape (M, 3), float32."""
    faces: np.ndarray
    """Triangles, counter-clockwise as seen from the lumen, shape (F, 3), int32."""
    normals: np.ndarray
    """Unit normals towards the lumen, shape (M, 3), float32."""
    uv: np.ndarray
    """Texture coordinates: u turns around the lumen, v along it, one unit each repeat of the texture, which covers
    :data:`TEXTURE_LENGTH`. Both may leave 0 to 1; shape (M, 2), float32."""
    tint: np.ndarray
    """Above 0 on polyps, below 0 inside diverticula, in [-1, 1], shape (M,), float32."""
    skin_indices: np.ndarray
    """Wall vertices that carry each vertex, shape (M, 4), int32."""
    skin_weights: np.ndarray
    """Their weights, summing to 1, shape (M, 4), float32."""


@dataclass(frozen=True)
class ContactSurface:
    """Inner surface that the scope touches, with folds that the wall is too coarse for.

    A grid of rows from the anal verge to the cecal pole and columns round the lumen, with vertex
    ``row * columns + column``, carried by the wall's inner layer. It closes after the last column; its last row is the
    pole, as often as there are columns. Rows and columns divide each cell of the wall evenly
    (:class:`arcgym.anatomy.grid_shape.GridShape`): with k columns a sector, the cell between rings r, r + 1 and
    sectors j, j + 1 carries rows ``r * k`` to ``(r + 1) * k`` and columns ``j * k`` to ``(j + 1) * k``; rows beyond the
    last ring are carried by it alone.
    """

    points: np.ndarray
    """Rest positions [m], shape (M, 3), float32."""
    columns: int
    """Points around the lumen."""
    skin_indices: np.ndarray
    """Wall vertices that carry each vertex, shape (M, 4), int32."""
    skin_weights: np.ndarray
    """Their weights, summing to 1, shape (M, 4), float32."""

    @property
    def rows(self) -> int:
        """Rows from the anal verge to the pole."""
        return len(self.points) // self.columns

    def faces(self) -> np.ndarray:
        """Return two triangles for each cell of the grid, normals out of the lumen, shape (F, 3), int32.

        Those at the pole have no area.
        """
        row, column = np.meshgrid(np.arange(self.rows - 1), np.arange(self.columns), indexing="ij")
        after = (column + 1) % self.columns
        a, b = row * self.columns + column, (row + 1) * self.columns + column
        c, d = (row + 1) * self.columns + after, row * self.columns + after
        halves = [np.stack([a, d, c], -1), np.stack([a, c, b], -1)]
        return np.concatenate([half.reshape(-1, 3) for half in halves]).astype(np.int32)


@dataclass(frozen=True)
class Centerline:
    """Centerline of the lumen from the anal verge to the cecal pole."""

    points: np.ndarray
    """Positions [m], shape (C, 3), float32."""
    arc: np.ndarray
    """Arc length s from the anal verge [m], shape (C,), float32."""
    radius: np.ndarray
    """Mean lumen radius between folds [m], shape (C,), float32."""
    segment: np.ndarray
    """Index into ``SEGMENTS``, shape (C,), int32."""


@dataclass(frozen=True)
class TissueMaterial:
    """Isotropic elastic material of the wall."""

    youngs_modulus: float = 5.0e6
    """Young's modulus [Pa]. The ARCGym paper's value; distended human colon in vivo is about ten times softer."""
    poissons_ratio: float = 0.49
    """Poisson's ratio: nearly incompressible soft tissue, as in the ARCGym paper."""
    density: float = 1040.0
    """Mass density [kg/m^3], soft tissue."""


@dataclass(frozen=True)
class ColonStage:
    """Everything a stage file says about one colon."""

    name: str
    """Short name, such as ``colon_1``."""
    wall: WallMesh
    """What is simulated."""
    visual: VisualMesh
    """Fine surface for videos (USD purpose ``render``)."""
    visual_proxy: VisualMesh
    """Coarse surface for policy images (USD purpose ``proxy``)."""
    centerline: Centerline
    """Centerline with radius and segment."""
    landmarks: dict[str, float]
    """Arc length s of each landmark [m], in ascending order."""
    material: TissueMaterial
    """Tissue of the wall."""
    albedo_texture: Path
    """Color of the mucosa, periodic in both directions."""
    detail_texture: Path
    """RGBA: slope along u, slope along v, height, wetness; periodic (see :mod:`arcgym.anatomy.mucosa.texture`)."""
    metadata: dict[str, Any] = field(default_factory=dict)
    """Provenance, licence, patient, frame."""
    contact: ContactSurface | None = None
    """What the scope touches; None where that is the wall's inner layer."""

    @property
    def length(self) -> float:
        """Length of the centerline [m]."""
        return float(self.centerline.arc[-1])

    def segment_bounds(self) -> dict[str, tuple[float, float]]:
        """Return arc length at start and end [m] of each segment that the colon has."""
        arc, code = self.centerline.arc, self.centerline.segment
        starts = {SEGMENTS[k]: float(arc[np.argmax(code == k)]) for k in dict.fromkeys(code.tolist())}
        ends = [*list(starts.values())[1:], self.length]
        return {name: (start, end) for (name, start), end in zip(starts.items(), ends, strict=True)}

    def segment_at(self, s: float) -> str:
        """Return the segment at arc length ``s`` [m]; beyond either end, the last one there."""
        bounds = self.segment_bounds()
        return next((name for name, (_, end) in bounds.items() if s < end), list(bounds)[-1])

    def segment_nodes(self, name: str) -> np.ndarray:
        """Return the wall vertices of a segment, shape (n,), int."""
        return np.flatnonzero(self.wall.segment == segment_index(name))
