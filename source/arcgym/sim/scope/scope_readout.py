# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Wall force on tip, windows and links over a control step, and where tip and camera are at its end."""

from __future__ import annotations

from collections.abc import Sequence

import newton
import numpy as np
import torch
import warp as wp

from arcgym.assets.endoscope import Endoscope
from arcgym.sim.contact.contact_search import ContactSearch
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.scope import readout_kernels as kernels
from arcgym.utils.world_rows import WorldRows

TIP_SPAN = 3
"""Rings on either side of the last link's own among which the tip is located."""


class ScopeReadout:
    """Sums up the wall forces of each physics step, and measures tip, camera and failures.

    W worlds, L links, K windows of scope (part 0 is the tip, the windows follow), R rings.

    Attributes:
        step_force: Wall force on each link, mean over one physics step; the coupling fills it [N], shape (W*L,), vec3.
        link_force: Wall force on each link, mean over the control step [N], shape (W*L,), vec3.
        link_force_norm: Its magnitude [N], shape (W*L,).
        link_force_peak: Largest magnitude of ``step_force`` in the control step [N], shape (W*L,).
        window_force: Wall force on tip and windows, mean over the control step [N], shape (W, K + 1), vec3.
        window_force_norm: Its magnitude [N], shape (W, K + 1).
        window_force_peak: Largest magnitude within a physics step of the control step [N], shape (W, K + 1).
        tip_pose: Front of the last link, shape (W,), transform.
        tip_velocity: Its velocity [m/s] and spin [rad/s], shape (W,), spatial_vector.
        camera_pose: Pose of the camera, shape (W,), transform.
        tip_arc: Arc length of the tip along the colon at rest [m], shape (W,).
        tip_distance: Distance of the tip from the deformed centerline [m], shape (W,).
        tip_direction: Direction of the deformed centerline there, shape (W,), vec3.
        broken: 1 where the state is not finite or farther than 10 m away, shape (W,), int.
        penetrated: 1 where a link's axis came close to the wall or behind it, set by the coupling, shape (W,), int.
    """

    def __init__(self, endoscope: Endoscope, ring_arcs: Sequence[np.ndarray], patient: wp.array, device: str):
        """Allocate the results.

        Args:
            endoscope: Endoscope of every world.
            ring_arcs: Arc length of each ring of each patient's colon at rest [m], shape (R,).
            patient: Patient of each world, shape (W,), int32.
            device: Warp device.
        """
        num_envs = len(patient)
        self.num_envs, self.device, self.link_count = num_envs, device, endoscope.num_bodies
        rows = num_envs * self.link_count
        self.step_force, self.link_force = (wp.zeros(rows, dtype=wp.vec3, device=device) for _ in range(2))
        self.link_force_norm, self.link_force_peak = (wp.zeros(rows, dtype=float, device=device) for _ in range(2))
        self._shares = window_shares(endoscope.force_windows.share, device)
        parts = (num_envs, endoscope.force_windows.count + 1)
        self.window_force = wp.zeros(parts, dtype=wp.vec3, device=device)
        self.window_force_norm, self.window_force_peak = (wp.zeros(parts, dtype=float, device=device) for _ in range(2))
        self.tip_pose, self.camera_pose = (wp.zeros(num_envs, dtype=wp.transform, device=device) for _ in range(2))
        self.tip_velocity = wp.zeros(num_envs, dtype=wp.spatial_vector, device=device)
        self.tip_arc, self.tip_distance = (wp.zeros(num_envs, dtype=float, device=device) for _ in range(2))
        self.tip_direction = wp.zeros(num_envs, dtype=wp.vec3, device=device)
        self.broken, self.penetrated = (wp.zeros(num_envs, dtype=int, device=device) for _ in range(2))
        links = (self.step_force, self.link_force, self.link_force_norm, self.link_force_peak)
        windows = (self.window_force, self.window_force_norm, self.window_force_peak)
        of_step = (self.penetrated, *links, *windows)
        self._of_step = WorldRows([wp.to_torch(array).view(num_envs, -1) for array in of_step])
        self._patient, self._ring_arc = patient, patient_array(ring_arcs, float, device)
        self._tip_offset = wp.vec3(0.0, 0.0, endoscope.tip_offset)
        camera = endoscope.stage.camera
        self._camera_offset = wp.transform(wp.vec3(*camera.position), wp.quat(*camera.quaternion))

    def clear(self) -> None:
        """Start a control step."""
        for array in (self.link_force, self.link_force_peak, self.window_force_peak, self.penetrated):
            array.zero_()

    def collect(self) -> None:
        """Add the physics step's forces to the control step's, and clear them."""
        wp.launch(
            kernels.raise_window_peaks,
            self.window_force.shape,
            inputs=[self.step_force, self.link_count, self._shares],
            outputs=[self.window_force_peak],
            device=self.device,
        )
        wp.launch(
            kernels.collect_forces,
            self.step_force.shape,
            outputs=[self.step_force, self.link_force, self.link_force_peak],
            device=self.device,
        )

    def finish(self, steps: int) -> None:
        """End a control step of ``steps`` physics steps: the sum becomes a mean."""
        wp.to_torch(self.link_force).mul_(1.0 / steps)

    def update(self, state: newton.State, contact: ContactSearch, x: wp.array) -> None:
        """Measure tip, camera, magnitudes and failures.

        Args:
            state: State of all scopes.
            contact: Contact search; its ring centers and the links' rings must be those of ``x`` and ``state``.
            x: Wall positions [m], shape (V, W), vec3.
        """
        wp.launch(
            kernels.measure_forces,
            self.link_force.shape,
            inputs=[self.link_force],
            outputs=[self.link_force_norm],
            device=self.device,
        )
        wp.launch(
            kernels.measure_windows,
            self.window_force.shape,
            inputs=[self.link_force, self.link_count, self._shares],
            outputs=[self.window_force, self.window_force_norm],
            device=self.device,
        )
        wp.launch(
            kernels.read_tip,
            self.num_envs,
            inputs=[state.body_q, state.body_qd, self.link_count, self._tip_offset, self._camera_offset],
            outputs=[self.tip_pose, self.tip_velocity, self.camera_pose],
            device=self.device,
        )
        wp.launch(
            kernels.locate_tip,
            self.num_envs,
            inputs=[self.tip_pose, contact.centers, self._patient, self._ring_arc, contact.ring, TIP_SPAN],
            outputs=[self.tip_arc, self.tip_distance, self.tip_direction],
            device=self.device,
        )
        self._flag_broken(state, x)

    def _flag_broken(self, state: newton.State, x: wp.array) -> None:
        self.broken.zero_()
        wp.launch(kernels.flag_broken_points, x.shape, inputs=[x], outputs=[self.broken], device=self.device)
        wp.launch(
            kernels.flag_broken_bodies,
            state.body_q.shape,
            inputs=[state.body_q, self.link_count],
            outputs=[self.broken],
            device=self.device,
        )

    def reset(self, ids: torch.Tensor) -> None:
        """Forget the control step of the worlds ``ids``, shape (n,), int64."""
        self._of_step.clear(ids)


def window_shares(share: np.ndarray, device: str) -> kernels.WindowShares:
    """Return the shares that are not zero, part by part.

    Args:
        share: Share of each link's force in each part of the scope, shape (K + 1, L).
        device: Warp device.
    """
    part, link = np.nonzero(share)
    shares = kernels.WindowShares()
    shares.first = wp.array(np.searchsorted(part, np.arange(len(share) + 1)), dtype=int, device=device)
    shares.link = wp.array(link, dtype=int, device=device)
    shares.share = wp.array(share[part, link], dtype=float, device=device)
    return shares
