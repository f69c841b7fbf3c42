# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Gas in the lumen of every world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
import warp as wp

from arcgym.assets.gas_cfg import GasCfg
from arcgym.sim.patient_arrays import patient_array
from arcgym.sim.wall import gas_kernels as kernels
from arcgym.sim.wall.ring_modes import RingModes
from arcgym.sim.wall.wall_parameters import WallParameters
from arcgym.sim.wall.wall_tension import WallTension
from arcgym.sim.wall.wall_topology import LumenTopology, ring_mean

GAS = "gas."
"""Begins the names of what the gas's future depends on. A state without them is that of a lumen to be filled."""
LEAST_SLICE = 0.2
"""Least share that a ring's slice has of the cylinder with its faces' area and distance from the middle; a blind end,
whose faces lie across the lumen, has less, and is not propped."""


class LumenGas:
    """One volume of gas in each world's lumen, from the anus to the blind end. W worlds, R rings.

    The scope's own volume is not taken off the lumen's, and gas passes everywhere freely.
    """

    def __init__(
        self,
        cfg: GasCfg,
        topology: LumenTopology,
        walls: Sequence[WallParameters],
        modes: Sequence[RingModes],
        triangles: np.ndarray,
        patient: wp.array,
        dt: float,
        device: str,
    ):
        """Measure the imaged lumens and allocate.

        Args:
            cfg: Settings.
            topology: Faces of the lumen.
            walls: Wall of each patient.
            modes: Its ring modes.
            triangles: Vertices of the shell's triangles, shape (F, 3).
            patient: Patient of each world, shape (W,), int32, read in every step.
            dt: Physics step [s].
            device: Warp device.
        """
        self.cfg, self.dt, self.device, self.num_envs = cfg, dt, device, len(patient)
        rest = [wall.points.astype(np.float64) for wall in walls]
        cuts = [slices(points, topology) for points in rest]
        self.lumen = _lumen(topology, patient, device)
        self.lumen.inverse_slice = patient_array([cut.inverse for cut in cuts], float, device)
        self.law = _law(cfg)
        self.state = kernels.GasState()
        start = cfg.imaging_pressure if cfg.start_pressure is None else cfg.start_pressure
        values = {"abdominal": cfg.abdominal_pressure, "start": start, "leak": cfg.leak_conductance}
        for name in ("amount", "pressure", "mean", "peak", "volume", "flow", "abdominal", "start", "leak"):
            setattr(self.state, name, wp.full(self.num_envs, values.get(name, 0.0), dtype=float, device=device))
        shape = (len(topology.ring_start) - 1, self.num_envs)
        self.parts = wp.zeros(shape, dtype=float, device=device)
        """Parts of the lumen's volume, between each ring's faces and the origin [m^3], shape (R, W)."""
        self.loads = kernels.GasLoads()
        self.loads.patient = patient
        for name in ("push", "draw", "share"):
            setattr(self.loads, name, wp.zeros(self.num_envs, dtype=float, device=device))
        self.loads.prop = wp.zeros(shape, dtype=float, device=device)
        ring = walls[0].ring[triangles].min(axis=1)
        self.loads.ring = wp.array(ring.astype(np.int32), dtype=int, device=device)
        tensions = [ties(points, triangles, walls[0].ring, cut.radius) for points, cut in zip(rest, cuts, strict=True)]
        self.loads.tie = patient_array(tensions, wp.vec2, device)
        self.loads.tense = int(cfg.pretension)
        held = (len(rest[0]), self.num_envs) if cfg.pretension else (0, 0)
        self.loads.hold = wp.zeros(held, dtype=wp.vec3, device=device)
        self.tension = None
        """What holds the imaged shapes against their tension, if the walls keep it at rest."""
        if cfg.pretension:
            self.tension = WallTension(walls, modes, triangles, tensions, self.law.imaged, self.loads, device)

    @property
    def memory(self) -> dict[str, torch.Tensor]:
        """What the gas's future depends on besides the wall, by name, as views of shape (W, 1).

        Lumens whose amount is 0 are filled at the start pressure by :meth:`fill`.
        """
        arrays = {"amount": self.state.amount, "pressure": self.state.pressure}
        return {f"{GAS}{name}": wp.to_torch(array)[:, None] for name, array in arrays.items()}

    @property
    def settings(self) -> dict[str, torch.Tensor]:
        """What may differ between worlds, shape (W,) each, see :class:`arcgym.assets.GasCfg`."""
        state = self.state
        arrays = {"abdominal_pressure": state.abdominal, "start_pressure": state.start, "leak_conductance": state.leak}
        return {f"{GAS}{name}": wp.to_torch(array) for name, array in arrays.items()}

    def hold(self, x: wp.array) -> None:
        """Turn what holds the imaged shape against its tension with the rings at ``x`` [m], shape (V, W), vec3."""
        if self.tension is not None:
            self.tension.turn(x)

    def measure(self, x: wp.array) -> None:
        """Measure volume, props and what holds the image of the lumen at ``x`` [m], shape (V, W), vec3."""
        shape, inputs = self.parts.shape, [x, self.lumen, self.law]
        if self.tension is None:
            self._launch(kernels.measure_slices, shape, inputs, [self.parts, self.loads.prop])
        else:
            self.tension.measure(x, self.lumen, self.law, self.parts)

    def fit_rigid(self) -> None:
        """Make a physics step of walls that do not move, after :meth:`measure`."""
        self._launch(kernels.fit_rigid, self.num_envs, [self.parts, self.law, self.dt], [self.state, self.loads])

    def fill(self, x: wp.array, mask: wp.array) -> None:
        """Fill lumens whose state was written without an amount of gas.

        Args:
            x: Wall positions [m], shape (V, W), vec3.
            mask: Worlds that were written to, shape (W,), bool; the others stay as they are.
        """
        self.measure(x)
        self._launch(kernels.fill_gas, self.num_envs, [self.parts, mask, self.law], [self.state, self.loads])

    def clear(self) -> None:
        """Start a control step."""
        self.state.mean.zero_()
        self.state.peak.fill_(-self.cfg.ambient_pressure)

    def finish(self, steps: int) -> None:
        """End a control step of ``steps`` physics steps: the sum becomes a mean."""
        wp.to_torch(self.state.mean).mul_(1.0 / steps)

    def reset(self, ids: torch.Tensor) -> None:
        """Stop flows of the worlds ``ids``, shape (n,), int64."""
        wp.to_torch(self.state.flow)[ids] = 0.0

    def _launch(self, kernel: wp.Kernel, shape: object, inputs: list[object], outputs: list[object]) -> None:
        wp.launch(kernel, shape, inputs=inputs, outputs=outputs, device=self.device)


@dataclass(frozen=True)
class Slices:
    """Slices of an imaged lumen, between the faces of each of its R rings and their middle."""

    inverse: np.ndarray
    """1 over ``gas_kernels.slice_volume`` [1/m^3], 0 where there is none to speak of, shape (R,)."""
    radius: np.ndarray
    """Twice cross-section over perimeter, the radius of a cylinder [m], 0 likewise, shape (R,)."""


def slices(points: np.ndarray, topology: LumenTopology) -> Slices:
    """Measure the slices of a lumen.

    Args:
        points: Positions [m], shape (V, 3).
        topology: Faces of the lumen.
    """
    inverse = np.zeros(len(topology.ring_start) - 1)
    radius = np.zeros(len(inverse))
    for r, (first, last) in enumerate(zip(topology.ring_start[:-1], topology.ring_start[1:], strict=True)):
        if first == last:
            continue
        corners = points[topology.faces[first:last]]
        corners = corners - corners.mean(axis=(0, 1))
        a, b, c = corners.transpose(1, 0, 2)
        cut = np.einsum("fi,fi->", a, np.cross(b, c)) / 3.0
        area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
        reach = np.linalg.norm(corners.mean(axis=1), axis=1).mean()
        if cut > LEAST_SLICE * area * reach:
            inverse[r], radius[r] = 1.0 / cut, 1.5 * cut / area
    return Slices(inverse, radius)


def ties(points: np.ndarray, triangles: np.ndarray, ring: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Return the tension of a tube under a pressure of 1 Pa as springs along the edges of its triangles.

    The tension is S = R (around around^T + lengthwise lengthwise^T / 2), that of a closed cylinder. Between two corners
    with the shape gradients m and m' a triangle of area A pulls by -A m.S.m' times their distance.

    Args:
        points: Imaged positions [m], shape (V, 3).
        triangles: Vertices, shape (F, 3).
        ring: Ring of each vertex, shape (V,).
        radius: Radius of each ring [m], shape (R,).

    Returns:
        Force over length, over pressure [m], of the edges from each corner to the next and the one after, (3*F, 2).
    """
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = normal / twice
    opposite = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]
    gradient = np.cross(normal[:, None], opposite) / twice[:, None]
    lowest = ring[triangles].min(axis=1)
    along = np.gradient(ring_mean(points, ring), axis=0)[lowest]
    along = along - (along * normal).sum(axis=1, keepdims=True) * normal
    along = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1.0e-12)
    around = np.cross(normal, along)
    tension = radius[lowest][:, None, None] * (
        around[:, :, None] * around[:, None] + 0.5 * along[:, :, None] * along[:, None]
    )
    pull = -0.5 * twice[:, :, None] * np.einsum("fai,fij,fbj->fab", gradient, tension, gradient)
    return np.stack([pull[:, [0, 1, 2], [1, 2, 0]], pull[:, [0, 1, 2], [2, 0, 1]]], axis=2).reshape(-1, 2)


def lids(faces: np.ndarray) -> np.ndarray:
    """Close the open ends of a surface by a fan of triangles each.

    Args:
        faces: Vertices, shape (F, 3), wound alike.

    Returns:
        Vertices of the lids, wound as the faces are, shape (n, 3), int32.
    """
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    count = int(faces.max()) + 1
    key, back = edges @ [count, 1], edges[:, ::-1] @ [count, 1]
    after = {int(b): int(a) for a, b in edges[~np.isin(key, back)]}  # along a lid's border, against the faces'
    out = []
    while after:
        first, here = after.popitem()
        while after[here] != first:
            out.append((first, here, after[here]))
            here = after.pop(here)
        after.pop(here)
    return np.array(out, np.int32).reshape(-1, 3)


def _lumen(topology: LumenTopology, patient: wp.array, device: str) -> kernels.LumenRings:
    """Return the faces that close the lumen, without what differs between patients."""
    count = len(topology.ring_start) - 1
    closing = lids(topology.faces)
    owner = np.zeros(int(topology.rings.max()) + 1, np.int64)
    for ring, row in enumerate(topology.rings):
        owner[row] = ring
    lowest = np.repeat(np.arange(count), np.diff(topology.ring_start))
    lowest = np.concatenate([lowest, owner[closing].min(axis=1)])
    faces = np.concatenate([topology.faces, closing]).astype(np.int32)
    order = np.lexsort((np.arange(len(faces)), lowest))
    start = np.searchsorted(lowest[order], np.arange(count + 1)).astype(np.int32)
    lumen = kernels.LumenRings()
    lumen.patient = patient
    lumen.face = wp.array(faces[order], dtype=wp.vec3i, device=device)
    lumen.start = wp.array(start, dtype=int, device=device)
    lumen.lid = wp.array(start[:-1] + np.diff(topology.ring_start), dtype=int, device=device)
    return lumen


def _law(cfg: GasCfg) -> kernels.GasLaw:
    law = kernels.GasLaw()
    law.ambient, law.imaged = cfg.ambient_pressure, cfg.imaging_pressure - cfg.abdominal_pressure
    law.leak_opening, law.suction_depth = cfg.leak_opening, cfg.suction_depth
    law.least_opening, law.prop_pressure = cfg.least_opening, cfg.prop_pressure
    return law
