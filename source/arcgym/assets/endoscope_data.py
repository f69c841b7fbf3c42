# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""State of an endoscope as tensors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch
import warp as wp

from arcgym.anatomy.segments import SEGMENTS

if TYPE_CHECKING:
    from arcgym.assets.endoscope import Endoscope
    from arcgym.sim.simulation import Simulation


class EndoscopeData:
    """Views on the simulation's arrays: they change with every step, so clone what you keep.

    N worlds, L links, K windows of scope, J joint coordinates, D joint velocities. Quaternions are (x, y, z, w).
    """

    def __init__(self, endoscope: Endoscope, sim: Simulation):
        """Make views on the simulation's arrays."""
        n, links = sim.num_envs, endoscope.num_bodies
        state, readout, readings = sim.state, sim.scope_readout, _readings(endoscope)
        pose = wp.to_torch(state.body_q).view(n, links, 7)
        twist = wp.to_torch(state.body_qd).view(n, links, 6)
        tip = wp.to_torch(readout.tip_pose)
        tip_twist = wp.to_torch(readout.tip_velocity)
        self.joint_pos: torch.Tensor = wp.to_torch(state.joint_q).view(n, -1)
        """Joint coordinates [m or rad], shape (N, J), in the order of ``Endoscope.joint_names``."""
        self.joint_vel: torch.Tensor = wp.to_torch(state.joint_qd).view(n, -1)
        """Joint velocities [m/s or rad/s], shape (N, D); D = J but for a free root, which has 6 instead of 7."""
        self.joint_pos_target: torch.Tensor = wp.to_torch(sim.control.joint_target_q).view(n, -1)
        """Joint targets [m or rad], shape (N, J)."""
        self.body_pos_w = pose[..., :3]
        """Centers of the links [m], shape (N, L, 3)."""
        self.body_quat_w = pose[..., 3:]
        """Orientations of the links, +Z towards the tip, shape (N, L, 4)."""
        self.body_lin_vel_w = twist[..., :3]
        """Velocities of the links' centers [m/s], shape (N, L, 3)."""
        self.body_ang_vel_w = twist[..., 3:]
        """Angular velocities of the links [rad/s], shape (N, L, 3)."""
        self.root_pos_w = self.body_pos_w[:, 0]
        """Center of the base link [m], shape (N, 3)."""
        self.root_quat_w = self.body_quat_w[:, 0]
        """Orientation of the base link, shape (N, 4)."""
        self.tip_pos_w = tip[:, :3]
        """Front of the tip [m], shape (N, 3)."""
        self.tip_quat_w = tip[:, 3:]
        """Orientation of the tip, +Z forward, shape (N, 4)."""
        self.tip_lin_vel_w = tip_twist[:, :3]
        """Velocity of the front of the tip [m/s], shape (N, 3)."""
        self.tip_ang_vel_w = tip_twist[:, 3:]
        """Angular velocity of the tip [rad/s], shape (N, 3)."""
        self.tip_arc_length: torch.Tensor = wp.to_torch(readout.tip_arc)
        """Arc length of the tip along the deformed centerline, in rest arc length from the anal verge [m], (N,)."""
        self.tip_centerline_distance: torch.Tensor = wp.to_torch(readout.tip_distance)
        """Distance of the tip from the deformed centerline [m], shape (N,)."""
        self.tip_lumen_direction_w: torch.Tensor = wp.to_torch(readout.tip_direction)
        """Direction of the deformed centerline beside the tip, away from the anus, shape (N, 3)."""
        window = wp.to_torch(readout.window_force)
        norm, peak = wp.to_torch(readout.window_force_norm), wp.to_torch(readout.window_force_peak)
        self.window_arc: torch.Tensor = torch.tensor(endoscope.force_windows.arc, dtype=torch.float, device=sim.device)
        """Distance of the middle of each window from the front of the tip, along the scope [m], shape (K,)."""
        self.window_force_w = window[:, 1:]
        """Force of the wall on each window, the vector sum over 50 mm of scope, mean over the control step [N], shape
        (N, K, 3). Windows follow each other every 25 mm, the first at the front of the tip; see
        :mod:`arcgym.assets.force_windows`."""
        self.window_force_norm = norm[:, 1:]
        """Magnitude of that force [N], shape (N, K)."""
        self.window_force_peak = peak[:, 1:]
        """Largest force of the wall on each window within the control step (mean over one physics step) [N], (N, K)."""
        self.tip_force_w = window[:, 0]
        """Force of the wall on the tip, the most distal 20 mm, mean over the control step [N], shape (N, 3)."""
        self.tip_force = norm[:, 0]
        """Magnitude of that force [N], shape (N,)."""
        self.tip_force_peak = peak[:, 0]
        """Largest force of the wall on the tip within the control step (mean over one physics step) [N], shape (N,)."""
        self.link_force_w: torch.Tensor = wp.to_torch(readout.link_force).view(n, links, 3)
        """Force of the wall on each link, mean over the control step [N], shape (N, L, 3). For diagnosis: it changes
        with the length of the links, so publish forces on windows."""
        self.link_force_norm: torch.Tensor = wp.to_torch(readout.link_force_norm).view(n, links)
        """Magnitude of that force [N], shape (N, L)."""
        self.link_force_peak: torch.Tensor = wp.to_torch(readout.link_force_peak).view(n, links)
        """Largest force of the wall on each link within the control step (mean over one physics step) [N], (N, L)."""
        self.base_force: torch.Tensor = readings.get("base_force", torch.zeros(n, device=sim.device))
        """Push on the base, mean over the control step [N], shape (N,); zero without a driven base."""
        self.tip_pull_force_w: torch.Tensor = readings.get("tip_pull_force_w", torch.zeros(n, 3, device=sim.device))
        """Pull on the tip, mean over the control step [N], shape (N, 3); zero where none pulls."""
        self.bending: torch.Tensor = readings.get("bending", torch.zeros(n, 2, device=sim.device))
        """Angles the bending section is driven to (pitch, yaw) [rad], shape (N, 2); zero without one."""
        self._rest_insertion = endoscope.rest_insertion
        self._has_shaft = endoscope.stage.root == "slide_roll"
        self._segment_spans = sim.colon.data.segment_spans

    @property
    def inserted_length(self) -> torch.Tensor:
        """Length of scope inside the anus [m], shape (N,); for a free capsule its arc length."""
        return self.joint_pos[:, 0] + self._rest_insertion if self._has_shaft else self.tip_arc_length

    @property
    def tip_segment(self) -> torch.Tensor:
        """Segment that the tip is in, index into ``SEGMENTS``, shape (N,), int64."""
        start, end = self._segment_spans.unbind(dim=2)
        passed = (end <= self.tip_arc_length.unsqueeze(1)).sum(dim=1)
        has = end > start
        last = len(SEGMENTS) - 1 - has.flip(1).byte().argmax(dim=1)
        return torch.minimum(torch.maximum(passed, has.byte().argmax(dim=1)), last)


def _readings(endoscope: Endoscope) -> dict[str, torch.Tensor]:
    """Return the readings of the actuators by name of the field.

    Raises:
        ValueError: If two actuators give the same one.
    """
    readings: dict[str, torch.Tensor] = {}
    for name, actuator in endoscope.actuators.items():
        for field, array in actuator.readings.items():
            if field in readings:
                raise ValueError(
                    f"Actuator {name!r} and one before it both give {field!r}; drop it from one's readings."
                )
            readings[field] = wp.to_torch(array)
    return readings
