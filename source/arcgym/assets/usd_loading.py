# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Loads colon and endoscope stages with Newton's USD importer, and checks that it took over everything.

Newton's importer skips or replaces what it does not understand with a warning at most. Here every number that matters
is compared with the stage, so that a scope is never simulated without its drives, or a colon with default tissue.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton
from newton import JointType, ModelBuilder, ParticleFlags, ShapeFlags

from arcgym.anatomy import ColonStage, StageError
from arcgym.anatomy.segments import ANCHOR_FIXED
from arcgym.anatomy.stage.layout import TISSUE_PATH, WALL_PATH
from arcgym.assets.endoscope_spec import capsule_half_height
from arcgym.assets.endoscope_stage import (
    ENDOSCOPE_PATH,
    JOINTS_PATH,
    LINKS_PATH,
    ROOT_JOINT_PATH,
    EndoscopeStage,
    link_name,
    turn_name,
)
from arcgym.assets.materials import solid_moduli

PARTICLE_RADIUS = 0.0005
"""Contact radius of a wall vertex [m]; Newton's own default is 0.1 m."""
UNLIMITED = 1.0e6
"""From this effort limit on a joint counts as unlimited [N], [N m]: Newton's default where a stage names none."""


@dataclass(frozen=True)
class EndoscopeIndices:
    """Where an endoscope lies in the arrays of a builder's model."""

    bodies: range
    """Links, base first."""
    shapes: range
    """Collision capsules, one a link."""
    joints: range
    """Root joint, then the hinges; the parent's before the child's."""
    coords: range
    """Entries of ``joint_q`` and ``joint_target_q``: 2 (slide, roll) or 7 (position, quaternion), then the hinges,
    the bending of each before its twist."""
    dofs: range
    """Entries of ``joint_qd``: 2 or 6, then the hinges."""


def add_colon_usd(builder: ModelBuilder, path: str | Path, stage: ColonStage) -> range:
    """Add the wall of the colon at `path` to `builder` and hold its fixed vertices still.

    Args:
        builder: Builder of one world, without a colon so far.
        path: The stage file.
        stage: The same stage as :func:`arcgym.anatomy.read_colon` reads it.

    Returns:
        Indices of the wall's particles; particle i is wall vertex i.

    Raises:
        StageError: If what Newton imported differs from `stage`.
    """
    first, first_tet = builder.particle_count, builder.tet_count
    radius, builder.default_particle_radius = builder.default_particle_radius, PARTICLE_RADIUS
    _import_stage(builder, path, WALL_PATH)
    builder.default_particle_radius = radius
    particles = range(first, builder.particle_count)
    check = _Check(path)
    tets = np.asarray(builder.tet_indices[first_tet:]).reshape(-1, 4) - first
    _check_wall_mesh(check, builder, particles, tets, stage)
    _check_tissue(check, builder, particles, first_tet, stage)
    for vertex in np.flatnonzero(stage.wall.anchor == ANCHOR_FIXED):
        builder.particle_mass[first + vertex] = 0.0
        builder.particle_flags[first + vertex] &= ~int(ParticleFlags.ACTIVE)
    return particles


def add_endoscope_usd(builder: ModelBuilder, path: str | Path, stage: EndoscopeStage) -> EndoscopeIndices:
    """Add the endoscope at `path` to `builder`, straight below the anus in its rest pose.

    The links do not collide with one another: the elastic hinges keep them apart.

    Args:
        builder: Builder of one world.
        path: The stage file.
        stage: The same stage as :func:`arcgym.assets.endoscope_stage.read_endoscope` reads it.

    Returns:
        Indices of its bodies, shapes, joints, coordinates and degrees of freedom.

    Raises:
        StageError: If what Newton imported differs from `stage`.
    """
    counts = _counts(builder)
    _import_stage(builder, path, ENDOSCOPE_PATH)
    indices = EndoscopeIndices(*(range(*ends) for ends in zip(counts, _counts(builder), strict=True)))
    check = _Check(path)
    _check_links(check, builder, indices, stage)
    _check_joints(check, builder, indices, stage)
    _check_drives(check, builder, indices, stage)
    _disable_self_collision(builder, indices.shapes)
    return indices


def _import_stage(builder: ModelBuilder, path: str | Path, root_path: str) -> None:
    """Import only what lies below `root_path` and is simulated."""
    options = {"load_visual_shapes": False, "load_static_visual_shapes": False, "load_sites": False}
    try:
        builder.add_usd(str(path), root_path=root_path, enable_self_collisions=False, **options)
    except ValueError as error:
        mend = (
            "Leave physics:jointEnabled on for every joint, and apply PhysicsLimitAPI to the root: low < high for "
            "transZ and rotZ, low > high for the other axes."
        )
        raise StageError(path, root_path, "", f"Newton's importer failed: {error}", mend) from error


def _counts(builder: ModelBuilder) -> tuple[int, int, int, int, int]:
    """Numbers of bodies, shapes, joints, coordinates and degrees of freedom so far."""
    return (
        builder.body_count,
        builder.shape_count,
        builder.joint_count,
        builder.joint_coord_count,
        builder.joint_dof_count,
    )


def _disable_self_collision(builder: ModelBuilder, shapes: range) -> None:
    """Let the links touch the wall only, and drop the pair filters, whose number would grow with L^2 per world."""
    builder.shape_collision_filter_pairs[:] = [
        pair for pair in builder.shape_collision_filter_pairs if pair[0] not in shapes or pair[1] not in shapes
    ]
    for shape in shapes:
        builder.shape_flags[shape] &= ~int(ShapeFlags.COLLIDE_SHAPES)


class _Check:
    """Compares what Newton imported with what the stage says."""

    def __init__(self, path: str | Path) -> None:
        self.path = path

    def equal(self, prim: str, attribute: str, found: object, expected: object, mend: str) -> None:
        """Raise unless `found` is `expected`."""
        if found != expected:
            raise StageError(self.path, prim, attribute, f"Newton imported {found} instead of {expected}", mend)

    def close(self, prims: Sequence[str], attribute: str, found: ArrayLike, expected: ArrayLike, mend: str) -> None:
        """Raise at the first prim whose value differs by more than the precision of a float."""
        have, want = np.asarray(found, float), np.asarray(expected, float)
        wrong = np.flatnonzero(~np.isclose(have, want, rtol=1e-4, atol=1e-12))
        if len(wrong):
            first = wrong[0]
            self.equal(prims[first], attribute, f"{have[first]:g}", f"{want[first]:g}", mend)


def _check_wall_mesh(
    check: _Check, builder: ModelBuilder, particles: range, tets: np.ndarray, stage: ColonStage
) -> None:
    wall = stage.wall
    mend = "Give the TetMesh the schemas that arcgym.anatomy.write_colon applies."
    check.equal(WALL_PATH, "points", len(particles), len(wall.points), mend)
    mend = "Swap two vertices of each inverted tetrahedron: Newton drops those without positive volume."
    check.equal(WALL_PATH, "tetVertexIndices", len(tets), len(wall.tets), mend)
    check.equal(WALL_PATH, "tetVertexIndices", bool((tets == wall.tets).all()), True, "Set orientation 'rightHanded'.")
    points = np.asarray(builder.particle_q)[particles.start : particles.stop]
    if not np.allclose(points, wall.points, atol=1e-6):
        offset = np.abs(points - wall.points).max()
        mend = "Set metersPerUnit = 1 and remove transforms above the TetMesh."
        raise StageError(check.path, WALL_PATH, "points", f"Newton moved them by up to {offset:g} m", mend)


def _check_tissue(check: _Check, builder: ModelBuilder, particles: range, first_tet: int, stage: ColonStage) -> None:
    """Lame parameters of every tetrahedron and the mass of the whole wall."""
    material = stage.material
    tets = builder.tet_materials[first_tet:]
    expected = solid_moduli(material.youngs_modulus, material.poissons_ratio)[:2]
    mend = f"Bind {TISSUE_PATH} to the TetMesh with purpose 'physics' and PhysicsVolumeDeformableMaterialAPI."
    for column, value in enumerate(expected):
        found = np.asarray(tets)[:, column]
        check.close([TISSUE_PATH] * len(tets), "physics:youngsModulus", found, np.full(len(tets), value), mend)
    edges = stage.wall.points[stage.wall.tets[:, 1:]] - stage.wall.points[stage.wall.tets[:, :1]]
    mass = material.density * np.linalg.det(edges.astype(float)).sum() / 6.0
    found = sum(builder.particle_mass[particles.start : particles.stop])
    check.close([TISSUE_PATH], "physics:density", [found], [mass], mend)


def _check_links(check: _Check, builder: ModelBuilder, indices: EndoscopeIndices, stage: EndoscopeStage) -> None:
    """Order, mass, radius and height of the links."""
    names = [f"{LINKS_PATH}/{link_name(link)}" for link in range(stage.num_links)]
    labels = builder.body_label[indices.bodies.start : indices.bodies.stop]
    check.equal(LINKS_PATH, "", labels, names, "Apply PhysicsRigidBodyAPI to every link and join them in order.")
    check.equal(LINKS_PATH, "", len(indices.shapes), stage.num_links, "Give each link one capsule 'Shape'.")
    check.close(names, "physics:mass", np.take(builder.body_mass, indices.bodies), stage.link_mass, "Set it above 0.")
    shapes = [f"{name}/Shape" for name in names]
    bodies = list(np.take(builder.shape_body, indices.shapes))
    check.equal(LINKS_PATH, "", bodies, list(indices.bodies), "Give each link one capsule 'Shape'.")
    scale = np.asarray(builder.shape_scale, dtype=float)[indices.shapes.start :]
    half_height = [
        capsule_half_height(length, radius, stage.num_links)
        for length, radius in zip(stage.link_length, stage.link_radius, strict=True)
    ]
    check.close(shapes, "radius", scale[:, 0], stage.link_radius, "Remove the scale above the shape.")
    check.close(shapes, "height", scale[:, 1], np.array(half_height), "Remove the scale above the shape.")


def _check_joints(check: _Check, builder: ModelBuilder, indices: EndoscopeIndices, stage: EndoscopeStage) -> None:
    """Types, order, axes and ranges of the joints."""
    types = [JointType(kind).name for kind in np.take(builder.joint_type, indices.joints)]
    root = "FREE" if stage.root == "free" else "D6"
    check.equal(JOINTS_PATH, "", types, [root, *["D6"] * (stage.num_links - 1)], "Join the links one after the other.")
    links = list(indices.bodies)
    check.equal(JOINTS_PATH, "", list(np.take(builder.joint_child, indices.joints)), links, "Number joints as links.")
    parents = [-1, *links[:-1]]
    check.equal(JOINTS_PATH, "", list(np.take(builder.joint_parent, indices.joints)), parents, "Start at the base.")
    root_dofs = 6 if stage.root == "free" else 2
    prims = _turn_prims(stage)
    mend = "Apply PhysicsLimitAPI with low < high for transZ and rotZ, and with low > high for the other axes."
    check.equal(ROOT_JOINT_PATH, "apiSchemas", len(indices.dofs), root_dofs + len(prims), mend)
    first = indices.dofs.start + root_dofs
    axes = ["XYZ"[int(np.argmax(np.abs(axis)))] for axis in builder.joint_axis[first:]]
    expected = ["XYZ"[axis] for _, axis in stage.turns]
    check.equal(JOINTS_PATH, "physics:axis", axes, expected, "Give each hinge bend_x, bend_y and twist in this order.")
    lower, upper = builder.joint_limit_lower[first:], builder.joint_limit_upper[first:]
    limit = stage.by_turn(stage.hinge_limit, stage.twist_limit)
    check.close(prims, "physics:lowerLimit", lower, -limit, "Author both limits, in degrees.")
    check.close(prims, "physics:upperLimit", upper, limit, "Author both limits, in degrees.")
    bends = stage.bend_coords.ravel() - stage.root_coords
    hinge_prims = [prims[bend] for bend in bends]
    stops, mend = np.asarray(builder.joint_limit_ke)[first + bends], "Apply NewtonJointAPI; its gains are per degree."
    check.close(hinge_prims, "newton:limitStiffness", stops, stage.stop_stiffness.ravel(), mend)
    armature = np.asarray(builder.joint_armature)[first + bends]
    check.close(hinge_prims, "newton:armature", armature, stage.hinge_armature.ravel(), mend)


def _turn_prims(stage: EndoscopeStage) -> list[str]:
    """Paths of the joints in the order of ``EndoscopeStage.turns``."""
    return [f"{JOINTS_PATH}/{turn_name(hinge, axis)}" for hinge, axis in stage.turns]


def _check_drives(check: _Check, builder: ModelBuilder, indices: EndoscopeIndices, stage: EndoscopeStage) -> None:
    """Stiffness, damping and force limit of the root and the hinges."""
    if stage.slide_drive is None or stage.roll_drive is None:
        return
    roots = (stage.slide_drive, stage.roll_drive)
    prims = [ROOT_JOINT_PATH] * 2 + _turn_prims(stage)
    dofs = slice(indices.dofs.start, indices.dofs.stop)
    stiffness = np.r_[[drive.stiffness for drive in roots], stage.by_turn(stage.hinge_stiffness, stage.twist_stiffness)]
    damping = np.r_[[drive.damping for drive in roots], stage.by_turn(stage.hinge_damping, stage.twist_damping)]
    effort = np.r_[[drive.max_force for drive in roots], np.full(len(stage.turns), math.inf)]
    mend = "Apply PhysicsDriveAPI of type 'force'; gains of angles are per degree."
    check.close(prims, "drive:physics:stiffness", builder.joint_target_ke[dofs], stiffness, mend)
    check.close(prims, "drive:physics:damping", builder.joint_target_kd[dofs], damping, mend)
    found = np.minimum(builder.joint_effort_limit[dofs], UNLIMITED)
    check.close(prims, "drive:physics:maxForce", found, np.minimum(effort, UNLIMITED), mend)
    stops = newton.JointTargetMode.NONE
    modes = list(builder.joint_target_mode[dofs])
    check.equal(JOINTS_PATH, "drive:physics:type", modes.count(int(stops)), 0, mend)
