# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Strain of the wall and tension of its anchors, averaged over a control step, with their peaks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
import warp as wp

from arcgym.assets.anchors import AnchorSprings
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall.strain_kernels import RestRings, measure_rings
from arcgym.sim.wall.wall_parameters import wall_anchors
from arcgym.sim.wall.wall_topology import LumenTopology
from arcgym.utils.threaded_graph import launch_rows
from arcgym.utils.world_rows import WorldRows


class WallReadout:
    """Measures every ring of every world in each physics step, with one kernel. W worlds, R rings, V vertices.

    All results have shape (R, W) and hold zero from a reset to the end of the next control step.

    Attributes:
        strain: Largest principal stretch of the ring's lumen faces minus one, mean over the control step.
        strain_peak: The largest of its physics steps.
        tension: Pull of the ring's anchors on the surroundings, the length of their summed forces [N], mean.
        tension_peak: The largest of its physics steps [N].
    """

    def __init__(
        self,
        topology: LumenTopology,
        points: Sequence[np.ndarray],
        ring: np.ndarray,
        anchors: Sequence[AnchorSprings],
        anchor_scale: wp.array,
        patient: wp.array,
        device: str,
    ):
        """Store the rest shape.

        Args:
            topology: Lumen faces of one world.
            points: Rest positions of each patient [m], shape (V, 3).
            ring: Ring of each vertex, shape (V,).
            anchors: Springs of each patient's vertices to their rest positions.
            anchor_scale: Factor of all springs of each world, read at every measurement, shape (W,).
            patient: Patient of each world, read at every measurement, shape (W,), int32.
            device: Warp device.
        """
        self._device = device
        self._shape = (len(topology.ring_start) - 1, len(anchor_scale))
        self._anchor_scale = anchor_scale
        self._rings = _rest_rings(topology, points, ring, anchors, patient, device)
        self.strain, self.strain_peak, self.tension, self.tension_peak = (
            wp.zeros(self._shape, dtype=float, device=device) for _ in range(4)
        )
        of_step = (self.strain, self.strain_peak, self.tension, self.tension_peak)
        self._of_step = WorldRows([wp.to_torch(array).T for array in of_step])

    def clear(self) -> None:
        """Start a control step."""
        for array in (self.strain, self.strain_peak, self.tension, self.tension_peak):
            array.zero_()

    def measure(self, x: wp.array) -> None:
        """Add one physics step with wall positions ``x`` [m], shape (V, W), vec3."""
        outputs = [self.strain, self.strain_peak, self.tension, self.tension_peak]
        launch_rows(measure_rings, self._shape, [x, self._rings, self._anchor_scale], outputs, self._device)

    def finish(self, steps: int) -> None:
        """End a control step of ``steps`` physics steps: sums become means."""
        for array in (self.strain, self.tension):
            wp.to_torch(array).mul_(1.0 / steps)

    def reset(self, ids: torch.Tensor) -> None:
        """Forget the control step of the worlds ``ids``, shape (n,), int64."""
        self._of_step.clear(ids)


def _rest_rings(
    topology: LumenTopology,
    points: Sequence[np.ndarray],
    ring: np.ndarray,
    springs: Sequence[AnchorSprings],
    patient: wp.array,
    device: str,
) -> RestRings:
    held = np.flatnonzero(np.any([spring.stiffness > 0.0 for spring in springs], axis=0))
    held = held[np.argsort(ring[held], kind="stable")]
    count = len(topology.ring_start) - 1
    rings = RestRings()
    rings.face = wp.array(topology.faces, dtype=wp.vec3i, device=device)
    rings.inverse = patient_array([inverse_rest(rest[topology.faces]) for rest in points], wp.vec3, device)
    rings.face_start = wp.array(topology.ring_start, dtype=int, device=device)
    rings.anchored = wp.array(held.astype(np.int32), dtype=int, device=device)
    rings.anchors = wall_anchors(points, springs, patient, device)
    start = np.searchsorted(ring[held], np.arange(count + 1)).astype(np.int32)
    rings.anchor_start = wp.array(start, dtype=int, device=device)
    return rings


def inverse_rest(corners: np.ndarray) -> np.ndarray:
    """Return the rest shape of triangles for :func:`arcgym.sim.wall.strain_kernels.face_strain`.

    Args:
        corners: Corners [m], shape (F, 3, 3).

    Returns:
        (1 / a, b / a, 1 / h) of the first edge's length a and the second's parts b along it and h across, shape (F, 3).
    """
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    a = np.linalg.norm(first, axis=1)
    b = np.einsum("fi,fi->f", first, second) / a
    h = np.linalg.norm(np.cross(first, second), axis=1) / a
    return np.stack([1.0 / a, b / a, 1.0 / h], axis=1)
