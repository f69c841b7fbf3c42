# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The colon as an asset: parameters for the simulation, state for managers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import newton
import numpy as np
import torch
import warp as wp

from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.stage import read_colon
from arcgym.assets.colon_cfg import ColonCfg
from arcgym.assets.materials import tissue_preset
from arcgym.assets.usd_loading import add_colon_usd, lame_parameters
from arcgym.utils.paths import resolve_asset

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation

FIXED = 2
"""Value of the stage's anchor primvar for vertices that never move."""


class Colon:
    """Soft colon of every world. V wall vertices, R rings, N worlds."""

    def __init__(self, cfg: ColonCfg):
        """Read and check the stage; nothing is allocated on the device yet.

        Raises:
            StageError: If the stage cannot be used.
            ValueError: If the material is unknown or a segment has no such name.
        """
        self.cfg = cfg
        self.path = resolve_asset(cfg.usd_path)
        self.stage = read_colon(self.path)
        self.tissue = tissue_preset(cfg.material)
        unknown = sorted(set(cfg.anchor_stiffness) - set(SEGMENTS))
        if unknown:
            raise ValueError(f"ColonCfg.anchor_stiffness names {unknown}; the segments are {list(SEGMENTS)}.")

    @property
    def num_nodes(self) -> int:
        """Number of wall vertices V."""
        return len(self.stage.wall.points)

    @property
    def num_rings(self) -> int:
        """Number of rings R along the centreline."""
        return len(self.stage.wall.ring_arc)

    def add_to(self, builder: newton.ModelBuilder) -> None:
        """Load the wall into ``builder`` and apply the material overrides."""
        first_tet = len(builder.tet_indices)
        particles = add_colon_usd(builder, self.path, self.stage)
        mu, lam = lame_parameters(*self.elasticity())
        for tet in range(first_tet, len(builder.tet_indices)):
            builder.tet_materials[tet] = (mu, lam, builder.tet_materials[tet][2])
        ratio = self._value("density") / self.stage.material.density
        for i in particles:
            builder.particle_mass[i] *= ratio

    def elasticity(self) -> tuple[float, float]:
        """Young's modulus [Pa] and Poisson's ratio in use."""
        return self._value("youngs_modulus"), self._value("poissons_ratio")

    def _value(self, name: str) -> float:
        """Material value: the configuration's, else the preset's, else the stage's."""
        values = [getattr(source, name) for source in (self.cfg, self.tissue, self.stage.material)]
        return next(value for value in values if value is not None)

    def mobile(self) -> np.ndarray:
        """Whether each wall vertex moves, shape (V,), bool."""
        wall = self.stage.wall
        free = wall.anchor != FIXED
        if self.cfg.mobile_until is not None:
            free &= wall.ring_arc[wall.ring] <= self.cfg.mobile_until
        return free

    def anchor_springs(self) -> np.ndarray:
        """Spring of each vertex to its rest position [N/m], shape (V,): the outer layer carries its ring's share."""
        wall = self.stage.wall
        per_length = {**self.tissue.anchor_stiffness, **self.cfg.anchor_stiffness}
        stiffness = np.array([per_length[name] for name in SEGMENTS])[wall.segment]
        outer = wall.layer == wall.layer.max()
        spacing = np.gradient(wall.ring_arc)[wall.ring]
        around = np.bincount(wall.ring[outer], minlength=self.num_rings)[wall.ring]
        return np.where(outer, stiffness * spacing / np.maximum(around, 1), 0.0)

    def bind(self, sim: Simulation) -> None:
        """Connect to the arrays of a built simulation; called once by it."""
        self._sim = sim
        self.nodal_pos_wp: wp.array = sim.nodal_pos
        self.data = ColonData(self, sim)

    def write_nodal_pos_to_sim(self, pos: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None) -> None:
        """Set wall positions [m], shape (n, V, 3), of the worlds ``env_ids`` (all by default)."""
        self.data.nodal_pos_w[self._worlds(env_ids)] = pos

    def write_nodal_velocity_to_sim(
        self, vel: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None
    ) -> None:
        """Set wall velocities [m/s], shape (n, V, 3), of the worlds ``env_ids`` (all by default)."""
        self.data.nodal_vel_w[self._worlds(env_ids)] = vel

    def write_nodal_state_to_sim(
        self, state: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None
    ) -> None:
        """Set wall positions and velocities, shape (n, V, 6), of the worlds ``env_ids`` (all by default)."""
        self.write_nodal_pos_to_sim(state[..., :3], env_ids)
        self.write_nodal_velocity_to_sim(state[..., 3:], env_ids)

    def write_stiffness_scale_to_sim(
        self, scale: torch.Tensor, env_ids: Sequence[int] | torch.Tensor | None = None
    ) -> None:
        """Multiply the wall's Young's modulus in the worlds ``env_ids``, shape (n,); 1 is the configured one."""
        self._sim.stiffness_scale[self._worlds(env_ids)] = scale

    @staticmethod
    def _worlds(env_ids: Sequence[int] | torch.Tensor | None) -> slice | torch.Tensor | Sequence[int]:
        return slice(None) if env_ids is None else env_ids


class ColonData:
    """State of the wall as tensors that share memory with the simulation."""

    def __init__(self, colon: Colon, sim: Simulation):
        """Make views on the simulation's arrays."""
        n, v = sim.num_envs, colon.num_nodes
        self.nodal_pos_w: torch.Tensor = wp.to_torch(sim.nodal_pos).view(n, v, 3)
        """Positions of the wall vertices [m], shape (N, V, 3)."""
        self.nodal_vel_w: torch.Tensor = wp.to_torch(sim.nodal_vel).view(n, v, 3)
        """Velocities of the wall vertices [m/s], shape (N, V, 3)."""
        self.centerline_pos_w: torch.Tensor = wp.to_torch(sim.ring_centres)
        """Centres of the deformed rings [m], shape (N, R, 3)."""
        wall = colon.stage.wall
        self.centerline_arc = torch.tensor(wall.ring_arc, dtype=torch.float32, device=sim.device)
        """Arc length of the rings at rest [m], shape (R,)."""
        rest = torch.tensor(wall.points, dtype=torch.float32, device=sim.device)
        self.default_nodal_state_w = torch.cat([rest, torch.zeros_like(rest)], dim=1).expand(n, v, 6)
        """Rest state of the wall vertices, position [m] and velocity [m/s], shape (N, V, 6)."""
        self.root_pos_w = torch.zeros(n, 3, device=sim.device)
        """Position of the anal verge [m], shape (N, 3): the origin."""

    @property
    def nodal_state_w(self) -> torch.Tensor:
        """Positions [m] and velocities [m/s] of the wall vertices, shape (N, V, 6)."""
        return torch.cat([self.nodal_pos_w, self.nodal_vel_w], dim=2)

    @property
    def nodal_displacement(self) -> torch.Tensor:
        """Distance of each wall vertex from its rest position [m], shape (N, V)."""
        return torch.linalg.vector_norm(self.nodal_pos_w - self.default_nodal_state_w[..., :3], dim=2)
