# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures with what they show: color, distance, normals and kind of surface, for learning from pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import torch
import warp as wp

from arcgym.sensors.camera_rays import fisheye_rays
from arcgym.sensors.shaft_picture import ShaftPicture
from arcgym.sensors.truth_kernels import look_closer
from arcgym.utils import warp_setup  # noqa: F401

if TYPE_CHECKING:
    from arcgym.assets.patient import Patient
    from arcgym.sensors.endoscope_camera import EndoscopeCamera

LABELS = ("nothing", "mucosa", "fold", "polyp", "diverticulum", "scope")
"""Kinds of surface by number."""
FOLD_DEPTH = 0.15
"""Share of the lumen's radius by which a fold stands out into the lumen; a choice, as no fold has a border."""
LESION_TINT = 0.1
"""Tint of the visual surface, which is 0 on plain mucosa and up to 1 on lesions, from which a vertex is of a lesion."""


class TruthImages:
    """Draws the scene that a camera sees in another size, with the truth about every pixel.

    The surface is the policy camera's, as of its last update. The scope's shaft is in the pictures, where a tip that is
    bent back sees it; it is not in the policy's.
    """

    def __init__(
        self,
        camera: EndoscopeCamera,
        patients: tuple[Patient, ...],
        size: tuple[int, int],
        samples: int = 1,
        endoscope: Any = None,
    ):
        """Allocate pictures.

        Args:
            camera: Camera of the scene, whose place, lens, lights and surface are used.
            patients: Patients of the worlds, in the order of ``colon.patients``.
            size: Width and height [px].
            samples: Rays a pixel of the color; the rest is of the pixel's middle.
            endoscope: Scope whose shaft is drawn; None for none.
        """
        self._camera, self._renderer = camera, camera.another_renderer(size, samples)
        renderer, device = self._renderer, self._renderer.device
        self.field_of_view = renderer.optics.field_of_view
        """Angle from corner to corner [rad]."""
        rays = fisheye_rays(*size, self.field_of_view, 1)
        self.rays: np.ndarray = rays[:, :, 0].astype(np.float32)
        """Direction of each pixel in the camera's frame, which looks along -Z with +Y up, shape (H, W, 3)."""
        self._rays = wp.array(rays, dtype=wp.vec3, device=device)
        labels = np.zeros((renderer.surface.num_vertices, len(patients)), np.uint8)
        for column, patient in enumerate(patients):
            labels[: len(patient.visual.points), column] = vertex_labels(patient)
        self._labels = wp.array(labels, dtype=wp.uint8, device=device)
        self._depth = wp.zeros(renderer.shape, dtype=float, device=device)
        self._normal = wp.zeros(renderer.shape, dtype=wp.vec3, device=device)
        self._label = wp.zeros(renderer.shape, dtype=wp.uint8, device=device)
        self._shaft = None if endoscope is None else ShaftPicture(endoscope, renderer, self._rays)
        renderer.overlay = None if self._shaft is None else self._shaft.draw
        self._everywhere = wp.full(renderer.shape[0], True, dtype=wp.bool, device=device)

    def draw(self, poses: wp.array) -> dict[str, torch.Tensor]:
        """Draw all worlds and return views of the pictures.

        Args:
            poses: Camera poses, shape (N,), transform.

        Returns:
            ``rgb`` uint8 (N, H, W, 3), ``depth`` [m] (N, H, W), ``normal`` in the camera's frame (N, H, W, 3),
            ``label``, index into :data:`LABELS`, uint8 (N, H, W), and ``pose``, position [m] and quaternion
            (x, y, z, w) of the camera (N, 7).
        """
        renderer = self._renderer
        renderer.draw(poses, self._camera.looks, self._everywhere)
        optics = renderer.optics
        wp.launch(
            look_closer,
            renderer.shape,
            inputs=[renderer.view, self._labels, poses, self._rays, renderer.covered, optics.near, optics.far],
            outputs=[self._depth, self._normal, self._label],
            device=renderer.device,
        )
        if self._shaft is not None:
            self._shaft.mark(self._depth, self._normal, self._label, LABELS.index("scope"))
        arrays = {"rgb": renderer.rgb, "depth": self._depth, "normal": self._normal, "label": self._label}
        return {name: wp.to_torch(array) for name, array in (arrays | {"pose": renderer.drawn_from}).items()}


def vertex_labels(patient: Patient) -> np.ndarray:
    """Return the kind of surface of each vertex of a patient's visual surface, index into :data:`LABELS`, shape (M,).

    Polyps and diverticula are those that the surface's tint marks. A fold is what stands out into the lumen by
    :data:`FOLD_DEPTH` of its radius, at rest.
    """
    visual, line = patient.visual, patient.centerline
    points = _refined(np.asarray(line.points, float))
    radius = np.interp(np.linspace(0.0, 1.0, len(points)), np.linspace(0.0, 1.0, len(line.radius)), line.radius)
    from scipy.spatial import cKDTree  # takes 0.1 s, which most starts can do without

    distance, nearest = cKDTree(points).query(visual.points)
    labels = np.full(len(visual.points), LABELS.index("mucosa"), np.uint8)
    labels[distance < (1.0 - FOLD_DEPTH) * radius[nearest]] = LABELS.index("fold")
    labels[visual.tint > LESION_TINT] = LABELS.index("polyp")
    labels[visual.tint < -LESION_TINT] = LABELS.index("diverticulum")
    return labels


def _refined(points: np.ndarray, factor: int = 8) -> np.ndarray:
    """Return a polyline with ``factor`` times as many points."""
    place = np.arange(len(points), dtype=float)
    dense = np.linspace(0.0, len(points) - 1.0, factor * len(points))
    return np.stack([np.interp(dense, place, points[:, axis]) for axis in range(3)], axis=1)
