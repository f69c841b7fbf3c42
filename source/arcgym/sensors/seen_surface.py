# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What of the mucosa the camera has seen, in every world: coverage and polyps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import torch
import warp as wp

from arcgym.anatomy.measures import face_normals
from arcgym.sensors.seen_kernels import mark_seen
from arcgym.sensors.truth_images import LESION_TINT
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.anatomy.stage import VisualMesh
    from arcgym.sensors.endoscope_camera import EndoscopeCamera

PARTS = 1_000_000_000
"""Parts in which shares of the mucosa are counted."""

SEAM = 1.0e-5
"""Distance below which vertices are the same place of the surface [m]."""


class SeenSurface:
    """Marks, vertex by vertex of the policy camera's surface, what its pictures have shown since the worlds' resets.

    A vertex stands for a third of the triangles around it, at rest. It is seen when the ray through the middle of a
    pixel meets a triangle nearest to it, within reach. N worlds, M vertices, P patients, K polyps of a patient at most.
    """

    def __init__(self, camera: EndoscopeCamera, visuals: Sequence[VisualMesh], reach: float) -> None:
        """Allocate the marks.

        Args:
            camera: Camera whose rays and surface are used.
            visuals: Surface of each patient that the camera sees, in the order of ``colon.patients``.
            reach: Distance beyond which nothing counts as seen [m].
        """
        self._camera, self._renderer, self.reach = camera, camera.renderer, reach
        renderer = self._renderer
        vertices, worlds, device = renderer.surface.num_vertices, renderer.surface.num_envs, renderer.device
        area = np.zeros((vertices, len(visuals)), np.int32)
        polyp = np.full((vertices, len(visuals)), -1, np.int32)
        for column, visual in enumerate(visuals):
            area[: len(visual.points), column] = vertex_shares(visual)
            polyp[: len(visual.points), column] = vertex_polyps(visual)
        self.num_polyps = torch.tensor(polyp.max(axis=0) + 1, device=device)
        """Polyps of each patient, shape (P,)."""
        self._area, self._polyp = (wp.array(values, dtype=wp.int32, device=device) for values in (area, polyp))
        self._whole = torch.tensor(area.sum(axis=0, dtype=np.int64), device=device)
        self._seen = wp.zeros((worlds, vertices), dtype=wp.int32, device=device)
        self._seen_area = wp.zeros(worlds, dtype=wp.int32, device=device)
        self._pixels = wp.zeros((worlds, max(int(polyp.max()) + 1, 1)), dtype=wp.int32, device=device)

    @property
    def coverage(self) -> torch.Tensor:
        """Share of the patient's mucosa that was seen since the world's reset, in [0, 1], shape (N,)."""
        patient = wp.to_torch(self._renderer.view.patient).long()
        return (wp.to_torch(self._seen_area).double() / self._whole[patient]).float()

    @property
    def polyp_pixels(self) -> torch.Tensor:
        """Pixels of the last picture that show each polyp, shape (N, K), int32."""
        return wp.to_torch(self._pixels)

    @property
    def memory(self) -> list[wp.array]:
        """What it remembers of every world, N entries each."""
        return [self._seen, self._seen_area, self._pixels]

    def look(self) -> None:
        """Mark what the camera's last pictures show."""
        renderer = self._renderer
        self._pixels.zero_()
        wp.launch(
            mark_seen,
            renderer.shape,
            inputs=[
                renderer.view,
                self._area,
                self._polyp,
                renderer.drawn_from,
                renderer.rays,
                renderer.covered,
                self.reach,
            ],
            outputs=[self._seen, self._seen_area, self._pixels],
            device=renderer.device,
        )

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget what was seen in the given worlds, int64, shape (n,); None for all."""
        for marks in self.memory:
            fill_worlds(wp.to_torch(marks), env_ids, 0)


def vertex_shares(visual: VisualMesh) -> np.ndarray:
    """Return the share of the mucosa at rest that each vertex stands for, in parts of a billion, shape (M,), int32."""
    twice = np.linalg.norm(face_normals(visual.points, visual.faces), axis=1)
    area = np.bincount(visual.faces.ravel(), np.repeat(twice, 3), minlength=len(visual.points))
    return np.round(PARTS * area / area.sum()).astype(np.int32)


def vertex_polyps(visual: VisualMesh) -> np.ndarray:
    """Return the number of the polyp that each vertex is of, -1 for none, shape (M,), int32.

    A polyp is a connected patch of vertices whose tint marks lesions, also across the seam of the texture, where two
    vertices lie in one place. They are numbered by their place on the surface.
    """
    _, place = np.unique(np.round(visual.points / SEAM), axis=0, return_inverse=True)
    marked = visual.tint > LESION_TINT
    corners = visual.faces[marked[visual.faces].all(axis=1)]
    edges = place.ravel()[np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]]])]
    count = int(place.max()) + 1
    from scipy.sparse import coo_array  # takes 0.4 s, which most starts can do without
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(edges), bool), (edges[:, 0], edges[:, 1])), shape=(count, count))
    _, patch = connected_components(graph, directed=False)
    in_patch = np.isin(place.ravel(), edges)
    polyps = np.full(len(visual.points), -1, np.int32)
    _, polyps[in_patch] = np.unique(patch[place.ravel()][in_patch], return_inverse=True)
    return polyps
