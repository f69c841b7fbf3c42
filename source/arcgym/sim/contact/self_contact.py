# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contact of the wall with itself where loops of the colon touch."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import warp as wp

from arcgym.sim.contact import self_contact_group_kernels as group_kernels
from arcgym.sim.contact import self_contact_kernels as kernels
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.simulation_cfg import WallSolverCfg
from arcgym.sim.wall.wall_topology import ring_mean
from arcgym.utils.warp_setup import GPU_BLOCK
from arcgym.utils.warp_vote_kernels import GROUP

MIN_ARC_RATIO = 1.25 * math.pi
"""Least arc length between rings that may touch, over their mean radius: a tube that turns back on itself touches
itself half a turn of its own radius further on, pi; a quarter more, since a bend's own folds do not count."""
MAX_STRETCH = 1.63
"""Stretch along the colon that the search reckons with: human colon tears there (Christensen et al. 2015)."""
MAX_DILATION = 1.25
"""How much wider than its widest ring at rest the search takes any ring to be."""


class SelfContact:
    """Contact of the wall with itself: keeps loops of the colon from passing through each other.

    Rings push on rings, so contact is as coarse as the rings are long; friction is
    :class:`arcgym.sim.contact.loop_friction.LoopFriction`'s. Rings that overlap at rest may go on doing so; folds of
    one stretch, and a wall gathered on the shaft, do not count.
    """

    def __init__(
        self,
        cfg: WallSolverCfg,
        points: Sequence[np.ndarray],
        ring: np.ndarray,
        members: np.ndarray,
        thickness: float,
        patient: wp.array,
        device: str,
    ):
        """Find which rings may touch, and allocate.

        Args:
            cfg: Solver settings.
            points: Rest positions of each patient's wall [m], shape (V, 3).
            ring: Ring of each vertex, shape (V,).
            members: Vertices of each ring, -1 padded, shape (R, S).
            thickness: Distance between vertices of walls that touch [m].
            patient: Patient of each world, shape (W,), int32, read in every step.
            device: Warp device.
        """
        self.device, num_envs = device, len(patient)
        self.count = count = len(members)
        reaches = [_reach(rest, ring) for rest in points]
        self.active = cfg.self_contact and any(bool(reach.may_touch.any()) for reach in reaches)
        self.rings = kernels.WallRings()
        self.rings.patient = patient
        self.rings.members = wp.array(members, dtype=int, device=device)
        gaps = [np.where(reach.may_touch, 0.0, kernels.NO_CONTACT) for reach in reaches]
        self.rings.min_gap = patient_array(gaps, float, device)
        self.rings.thickness, self.rings.stiffness = thickness, cfg.self_contact_stiffness
        self.rings.half_min_arc = patient_array([reach.half_min_arc for reach in reaches], float, device)
        self.rings.next_candidate = patient_array([_next_candidate(reach.may_touch) for reach in reaches], int, device)
        self.rings.max_radius = wp.array([reach.max_radius for reach in reaches], dtype=float, device=device)
        self.rings.max_spacing = wp.array([reach.max_spacing for reach in reaches], dtype=float, device=device)
        self.spheres = self._spheres(num_envs)
        self.force = kernels.SelfContactForce()
        self.force.plane = wp.zeros((len(ring), num_envs), dtype=wp.vec4, device=device)
        self.force.stiffness = wp.zeros((len(ring), num_envs), dtype=float, device=device)
        self.force.in_contact = wp.zeros((count, num_envs), dtype=int, device=device)
        self._watched = False
        self.lanes = GROUP if wp.get_device(device).is_cuda else 0
        """Threads that share a ring's vertices out, see :mod:`.self_contact_group_kernels`; 0 for the plain kernels."""
        if self.active:
            self._measure_rest(points, self.rings)

    def _spheres(self, num_envs: int) -> kernels.RingSpheres:
        spheres = kernels.RingSpheres()
        spheres.sphere = wp.zeros((self.count, num_envs), dtype=wp.vec4, device=self.device)
        spheres.near = wp.zeros((self.count, num_envs), dtype=int, device=self.device)
        return spheres

    def rings_of_any_pair(self, points: Sequence[np.ndarray]) -> kernels.WallRings:
        """Return the rings with gaps that hold for every pair, and measure the spheres in every step from here on.

        Args:
            points: Rest positions of each patient's wall [m], shape (V, 3).
        """
        self._watched = True
        rings = kernels.WallRings()
        for name in kernels.WallRings.__annotations__:
            setattr(rings, name, getattr(self.rings, name))
        rings.min_gap = wp.zeros_like(self.rings.min_gap)
        self._measure_rest(points, rings)
        return rings

    def _measure_rest(self, points: Sequence[np.ndarray], rings: kernels.WallRings) -> None:
        """Lower the gaps of ``rings`` to those at rest."""
        x, spheres = patient_array(points, wp.vec3, self.device), self._spheres(len(points))
        shape = (self.count, len(points))
        wp.launch(kernels.measure_spheres, shape, inputs=[x, rings], outputs=[spheres], device=self.device)
        wp.launch(
            kernels.allow_rest_overlaps,
            (self.count, *shape),
            inputs=[x, spheres],
            outputs=[rings],
            device=self.device,
        )

    def measure(self, x: wp.array) -> kernels.SelfContactForce:
        """Measure self-contact for the coming step.

        Args:
            x: Wall positions [m], shape (V, W), vec3.
        """
        shape, rings, spheres = self.force.in_contact.shape, self.rings, self.spheres
        if self.active or self._watched:
            wp.launch(kernels.measure_spheres, shape, inputs=[x, rings], outputs=[spheres], device=self.device)
        if self.active:
            wp.launch(kernels.find_near_rings, shape, inputs=[rings], outputs=[spheres], device=self.device)
            self._measure([x, rings, spheres])
        return self.force

    def _measure(self, inputs: list[object]) -> None:
        shape: tuple[int, ...] = self.force.in_contact.shape
        kernel = kernels.measure_self_contact
        if self.lanes > 0:
            kernel, shape = group_kernels.measure_self_contact_in_groups, (*shape, self.lanes)
            inputs = [*inputs, self.lanes]
        wp.launch(kernel, shape, inputs=inputs, outputs=[self.force], device=self.device, block_dim=GPU_BLOCK)


@dataclass(frozen=True)
class _Reach:
    """What decides which rings of a wall may touch."""

    may_touch: np.ndarray
    """Which pairs of rings are far enough apart along the colon, shape (R, R), bool."""
    half_min_arc: np.ndarray
    """Half the least arc length at which two such rings may touch [m], shape (R,)."""
    max_radius: float
    """No ring reaches farther from its center than this [m]."""
    max_spacing: float
    """No two neighboring rings are farther apart than this [m]."""


def _reach(points: np.ndarray, ring: np.ndarray) -> _Reach:
    center = ring_mean(points, ring)
    away = np.linalg.norm(points - center[ring], axis=1)
    spacing = np.linalg.norm(np.diff(center, axis=0), axis=1)
    half_min_arc = 0.5 * MIN_ARC_RATIO * ring_mean(away, ring)
    return _Reach(
        may_touch=_may_touch(spacing, half_min_arc),
        half_min_arc=half_min_arc,
        max_radius=MAX_DILATION * float(away.max()),
        max_spacing=MAX_STRETCH * float(spacing.max(initial=1.0e-3)),
    )


def _may_touch(spacing: np.ndarray, half_min_arc: np.ndarray) -> np.ndarray:
    """Return which pairs of rings are far enough apart along the colon, shape (R, R), bool."""
    arc = np.concatenate([[0.0], np.cumsum(spacing)])
    return np.abs(np.subtract.outer(arc, arc)) > np.add.outer(half_min_arc, half_min_arc)


def _next_candidate(may_touch: np.ndarray) -> np.ndarray:
    """Return the first ring after each that it may touch, or the number of rings, shape (R,)."""
    later = np.triu(may_touch)
    return np.where(later.any(axis=1), later.argmax(axis=1), len(later)).astype(np.int32)
