# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Newton builders of one world, and the numbers of its wall."""

from __future__ import annotations

import numpy as np

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton
from newton.solvers import SolverMuJoCo

from arcgym.anatomy.wall import inner_faces
from arcgym.assets.colon import Colon
from arcgym.assets.endoscope import Endoscope
from arcgym.sim.ring_modes import RingModes, ring_modes
from arcgym.sim.wall_solver import WallParameters
from arcgym.sim.wall_topology import LumenTopology, lumen_topology


def empty_builder() -> newton.ModelBuilder:
    """Builder without gravity that takes MuJoCo's attributes."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    SolverMuJoCo.register_custom_attributes(builder)
    return builder


def scope_builder(endoscope: Endoscope, mass_scaling: float) -> newton.ModelBuilder:
    """Builder of one world with the scope alone."""
    builder = empty_builder()
    endoscope.add_to(builder, mass_scaling)
    return builder


def wall_parameters(colon: Colon) -> WallParameters:
    """The wall as Newton imports and colours it, in numpy."""
    builder = empty_builder()
    colon.add_to(builder)
    builder.color()
    return WallParameters(
        points=np.array(builder.particle_q, dtype=np.float64).reshape(-1, 3),
        tets=np.array(builder.tet_indices, dtype=np.int32).reshape(-1, 4),
        lame=np.array(builder.tet_materials, dtype=np.float64)[:, :2],
        mass=np.array(builder.particle_mass, dtype=np.float64),
        mobile=colon.mobile(),
        anchor=colon.anchor_springs(),
        ring=colon.stage.wall.ring,
        colours=[np.asarray(group) for group in builder.particle_color_groups],
    )


def wall_modes(wall: WallParameters) -> RingModes:
    """Ring modes of the wall."""
    return ring_modes(wall.points, wall.tets, wall.ring, wall.mobile, wall.mass, wall.anchor, wall.lame)


def wall_lumen(colon: Colon) -> LumenTopology:
    """Lumen faces of the wall, sorted along the centreline."""
    wall = colon.stage.wall
    return lumen_topology(inner_faces(wall.tets, wall.layer), wall.ring, wall.layer)
