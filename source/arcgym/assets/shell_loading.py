# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A shell as Newton particles, triangles and bending edges."""

from __future__ import annotations

import numpy as np
from newton import ModelBuilder

from arcgym.anatomy.shell import ShellMesh
from arcgym.assets.shell_geometry import shell_geometry
from arcgym.assets.usd_loading import PARTICLE_RADIUS


def add_shell(builder: ModelBuilder, shell: ShellMesh, density: float, moduli: tuple[float, float, float]) -> None:
    """Add a shell to ``builder``.

    Args:
        builder: Newton builder, changed in place.
        shell: The wall.
        density: Mass density [kg/m^3].
        moduli: Shear and second Lamé parameter of the membrane [N/m], flexural rigidity [N m].
    """
    geometry = shell_geometry(shell.points, shell.triangles)
    first = builder.particle_count
    radius = 0.5 * shell.thickness + PARTICLE_RADIUS
    mass = np.zeros(len(shell.points))
    np.add.at(mass, shell.triangles, (density * shell.thickness / 3.0) * geometry.area[:, None])
    builder.add_particles(
        shell.points.tolist(), np.zeros_like(shell.points).tolist(), mass.tolist(), radius=[radius] * len(mass)
    )
    count = len(shell.triangles)
    builder.add_triangles(
        *(first + shell.triangles.T),
        tri_ke=[moduli[0]] * count,
        tri_ka=[moduli[1]] * count,
        tri_kd=[0.0] * count,
        tri_drag=[0.0] * count,
        tri_lift=[0.0] * count,
    )
    length = np.linalg.norm(shell.points[geometry.hinges[:, 3]] - shell.points[geometry.hinges[:, 2]], axis=1)
    builder.add_edges(
        *(first + geometry.hinges.T),
        rest=geometry.rest_angle.tolist(),
        edge_ke=(moduli[2] * geometry.coupling[:, 0, 0] / length).tolist(),  # Newton multiplies by the edge's length
        edge_kd=[0.0] * len(length),
    )
