# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Newton builders of one world, and the numbers of its wall."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import warp as wp

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton

from arcgym.anatomy.measures import inner_faces
from arcgym.anatomy.shell import ShellMesh
from arcgym.anatomy.stage import WallMesh
from arcgym.assets.colon import Colon
from arcgym.assets.endoscope import Endoscope
from arcgym.assets.shell_geometry import shell_geometry
from arcgym.sim.contact.carried_surface import CarriedSurface
from arcgym.sim.wall.ring_modes import RingModes, ring_modes
from arcgym.sim.wall.thickness import thickness_shares
from arcgym.sim.wall.wall_parameters import ShellParameters, SolidParameters, WallParameters
from arcgym.sim.wall.wall_topology import LumenTopology, lumen_topology


def empty_builder() -> newton.ModelBuilder:
    """Return a builder without gravity."""
    return newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))


def scope_model(endoscope: Endoscope, mass_scaling: float, num_envs: int, device: str) -> newton.Model:
    """Build the model of the scopes of all worlds: links and joints, no shapes."""
    world, builder = empty_builder(), empty_builder()
    endoscope.add_to(world, mass_scaling)
    drop_shapes(world)
    builder.replicate(world, num_envs)
    return builder.finalize(device=device)


def drop_shapes(builder: newton.ModelBuilder) -> None:
    """Remove the shapes of a builder whose model needs none: contacts here take the links' sizes from the stage.

    Newton finalizes shapes one by one, which takes a second for 1024 worlds of 121 links.
    """
    for name, values in vars(builder).items():
        if name.startswith("shape_") and isinstance(values, list):
            values.clear()
    builder.shape_collision_filter_pairs = []
    builder.body_shapes = {body: [] for body in builder.body_shapes}


def wall_parameters(colon: Colon, patient: int = 0) -> WallParameters:
    """Return the wall of a patient as Newton imports and colors it, in numpy."""
    builder = empty_builder()
    colon.add_to(builder, patient)
    wall = colon.patients[patient].wall
    builder.color(include_bending=isinstance(wall, ShellMesh))
    points = np.array(builder.particle_q, dtype=np.float64).reshape(-1, 3)
    share = thickness_shares(colon.cfg.wall_law, points, wall.ring, colon.thickness)
    return WallParameters(
        points=points,
        elements=_elements(wall, builder, share),
        moduli=colon.moduli(*colon.elasticity()),
        mass=np.array(builder.particle_mass, dtype=np.float64) * share[wall.ring],
        mobile=colon.mobile(patient),
        anchor=colon.anchor_springs(patient),
        ring=wall.ring,
        thickness=2.0 * colon.surface_offset,
        share=share,
        colors=[np.asarray(group) for group in builder.particle_color_groups],
    )


def _elements(
    wall: ShellMesh | WallMesh, builder: newton.ModelBuilder, share: np.ndarray
) -> ShellParameters | SolidParameters:
    if isinstance(wall, ShellMesh):
        return ShellParameters(shell_geometry(wall.points, wall.triangles, share[wall.ring]))
    return SolidParameters(np.array(builder.tet_indices, dtype=np.int32).reshape(-1, 4))


def wall_modes(wall: WallParameters) -> RingModes:
    """Return the ring modes of the wall."""
    return ring_modes(wall.points, wall.ring, wall.mobile, wall.mass, wall.anchor.stiffness, wall.share)


def carried_surface(
    colon: Colon, rest: Sequence[np.ndarray], lumen: LumenTopology, patient: wp.array, rows_alone: bool
) -> CarriedSurface:
    """Return the fine surface that the walls carry.

    Args:
        colon: Colon of every world.
        rest: Rest positions of each patient's wall [m], shape (V, 3).
        lumen: Faces of a wall that the scope would touch without it.
        patient: Patient of each world, shape (W,), int32.
        rows_alone: Whether to take all rows of the stages' surfaces, but no columns between the wall's.

    Raises:
        ValueError: If a stage has none, or they do not fit the wall or each other.
    """
    surfaces = []
    for one in colon.patients:
        surface = one.contact
        if surface is None:
            raise ValueError(
                f"{one.path} has no contact surface, which env.sim.contact.surface=fine needs: make the stage anew "
                "with 'arcgym make-colon' or 'arcgym import-colon', or set env.sim.contact.surface=wall."
            )
        surfaces.append(surface)
    return CarriedSurface(surfaces, rest, lumen, patient, rows_alone)


def wall_lumen(wall: ShellMesh | WallMesh) -> LumenTopology:
    """Return the faces of a wall that the scope touches, sorted along the centerline."""
    faces = wall.triangles if isinstance(wall, ShellMesh) else inner_faces(wall.tets, wall.layer)
    return lumen_topology(wall.points, faces, wall.ring, wall.layer)
