# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Where camera and wall were when the light of a late picture was collected."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import torch
import warp as wp

from arcgym.sensors import motion_kernels as kernels

if TYPE_CHECKING:
    from arcgym.scene.interactive_scene import InteractiveScene


@dataclass(frozen=True)
class Shot:
    """Camera and wall of every world at one moment. N worlds, V wall vertices."""

    pose: wp.array
    """Camera pose, shape (N,), transform."""
    motion: wp.array
    """Its velocity [m/s] and spin [rad/s] in its own frame, shape (N,), spatial_vector."""
    wall: wp.array | None
    """Wall vertices [m], shape (V, N), vec3; None where the present ones are meant."""


class CameraView:
    """Keeps camera and wall of the physics step nearest to the latency before the end of a control step.

    With a latency longer than a control step the shots of several are kept, the oldest first. The launches can be
    captured in a graph, one for each physics step of a control step.
    """

    def __init__(self, scene: InteractiveScene, latency: float):
        """Watch the simulation of a scene.

        Args:
            scene: The scene; its simulation is there.
            latency: Age of a picture when it is seen [s]; rounded to physics steps.
        """
        self._sim, self._device = scene.sim, str(scene.device)
        stage = scene["endoscope"].stage.camera
        self._offset = wp.transform(wp.vec3(*stage.position), wp.quat(*stage.quaternion))
        self._links, self._count = scene["endoscope"].num_bodies, scene.num_envs
        self._everywhere = wp.ones(self._count, dtype=wp.bool, device=self._device)
        self.lag: int = round(latency / self._sim.physics_dt)
        """Age of a picture [physics steps]."""
        self._shots = [self._empty()]
        if self.lag > 0:
            self._sim.watchers.append(self._watch)

    @property
    def shot(self) -> Shot:
        """What the next picture shows."""
        return self._shots[0]

    def refresh(self, taken: wp.array, stepped: bool) -> None:
        """Make the shot of some worlds ready before they are drawn.

        Args:
            taken: Worlds that will be drawn, shape (N,), bool.
            stepped: Whether a control step has just ended; else their state was written to, and they are shown as if
                they had stood there for long.
        """
        if self.lag == 0 or not stepped:
            for shot in self._shots:
                self._take(shot, taken)

    @property
    def memory(self) -> dict[str, torch.Tensor]:
        """All shots, as views of shape (N, ...)."""
        if self.lag == 0:
            return {}
        views = {}
        for number, shot in enumerate(self._shots):
            views[f"shot_{number}_pose"], views[f"shot_{number}_motion"] = map(wp.to_torch, (shot.pose, shot.motion))
            views[f"shot_{number}_wall"] = wp.to_torch(shot.wall).transpose(0, 1)
        return views

    def _watch(self, left: int, steps: int) -> None:
        """Take a shot if this physics step is the one: ``left`` of the ``steps`` of a control step are to come."""
        late = (self.lag - 1) // steps  # whole control steps between the shot and the one that shows it
        while len(self._shots) < late + 1:
            self._shots.append(self._empty())
            self._take(self._shots[-1], self._everywhere)
        if left == self.lag - late * steps:
            for older, newer in zip(self._shots, self._shots[1:], strict=False):
                for kept, copied in ((older.pose, newer.pose), (older.motion, newer.motion), (older.wall, newer.wall)):
                    wp.copy(kept, copied)
            self._take(self._shots[-1], self._everywhere)

    def _take(self, shot: Shot, taken: wp.array) -> None:
        state = self._sim.state
        inputs = [state.body_q, state.body_qd, self._links, self._offset, taken]
        wp.launch(kernels.look_from, self._count, inputs=inputs, outputs=[shot.pose, shot.motion], device=self._device)
        if shot.wall is not None:
            inputs = [self._sim.nodal_pos, taken]
            wp.launch(kernels.keep_wall, shot.wall.shape, inputs=inputs, outputs=[shot.wall], device=self._device)

    def _empty(self) -> Shot:
        wall = wp.clone(self._sim.nodal_pos) if self.lag > 0 else None
        pose = wp.zeros(self._count, dtype=wp.transform, device=self._device)
        return Shot(pose, wp.zeros(self._count, dtype=wp.spatial_vector, device=self._device), wall)
