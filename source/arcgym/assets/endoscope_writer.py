# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Writes the USD stage of an endoscope: links, joints with their drives, camera and lights."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdLux, UsdPhysics

from arcgym.assets.endoscope_spec import (
    REST_TIP_HEIGHT,
    TWIST_LIMIT,
    DriveSpec,
    EndoscopeSpec,
    capsule_half_height,
    endoscope_specs,
)

ENDOSCOPE_PATH = "/Endoscope"
LINKS_PATH = "/Endoscope/Links"
JOINTS_PATH = "/Endoscope/Joints"
ROOT_JOINT_PATH = "/Endoscope/Joints/root"
"""Prim paths of an endoscope's stage."""
ROLL_LIMIT = 3600.0
"""Range of the roll to either side [deg]: ten turns, practically free, but an axis without a range is not imported."""
TURNS = ("bend_x", "bend_y", "twist")
"""Names of a hinge's joints, about X, Y and Z; Newton merges them in alphabetical order."""
SLIDE_MARGIN = 0.5
"""How far the scope may be withdrawn below its rest pose [m]."""


def author_endoscopes(out_dir: Path) -> list[Path]:
    """Write the stages of all shipped endoscopes into `out_dir`. Returns their paths.

    A scope with a shaft, of a hundred links and more, is a short text layer over a binary one, as a colon is.
    """
    out_dir.mkdir(parents=True, exist_ok=True)
    return [_write_shipped(spec, out_dir / f"{spec.name}.usda") for spec in endoscope_specs()]


def write_endoscope(spec: EndoscopeSpec, path: str | Path) -> Path:
    """Write the USD stage of `spec` to `path`, replacing what is there.

    The rest pose is straight along +Z on the world's Z axis, with the tip 2 cm above the anal verge.
    """
    layer = Sdf.Layer.CreateAnonymous(".usda")
    stage = Usd.Stage.Open(layer)
    _write_header(stage, spec)
    nodes = REST_TIP_HEIGHT - spec.total_length + np.r_[0.0, np.cumsum(spec.link_length)]
    for link in range(len(spec.link_length)):
        _write_link(stage, spec, link, 0.5 * (nodes[link] + nodes[link + 1]))
    _write_optics(stage, spec)
    if spec.root == "slide_roll":
        _write_root(stage, spec, 0.5 * (nodes[0] + nodes[1]))
    for hinge in range(1, len(spec.link_length)):
        _write_hinge(stage, spec, hinge)
    layer.Export(str(path))
    return Path(path)


def _write_shipped(spec: EndoscopeSpec, path: Path) -> Path:
    """Write the stage of a shipped endoscope. Returns `path`.

    With a shaft `path` (text: units, sources) lies over the whole stage in ``<path with .usdc>`` (binary).
    """
    if spec.root == "free":
        return write_endoscope(spec, path)
    whole = write_endoscope(spec, path.with_suffix(".usdc"))
    layer = Sdf.Layer.CreateAnonymous(".usda")
    _write_header(Usd.Stage.Open(layer), spec)
    layer.subLayerPaths.append(f"./{whole.name}")
    layer.Export(str(path))
    return path


def link_name(link: int) -> str:
    """Name of the prim of link number `link`, counted from 0 at the base."""
    return f"link_{link:02d}"


def turn_name(hinge: int, axis: int) -> str:
    """Name of the prim of hinge number `hinge`, counted from 1, about X (0), Y (1) or Z (2)."""
    return f"{TURNS[axis]}_{hinge:02d}"


def _write_header(stage: Usd.Stage, spec: EndoscopeSpec) -> None:
    """Units, the articulation root and what describes the whole scope."""
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, ENDOSCOPE_PATH).GetPrim()
    stage.SetDefaultPrim(root)
    Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
    UsdPhysics.ArticulationRootAPI.Apply(root)
    root.AddAppliedSchema("NewtonArticulationRootAPI")
    _set(root, "newton:selfCollisionEnabled", Sdf.ValueTypeNames.Bool, False)
    _set(root, "arcgym:bendingLinks", Sdf.ValueTypeNames.Int, spec.bending_links)
    root.SetCustomData({"licence": "BSD-3-Clause", "sources": spec.sources})
    UsdGeom.Scope.Define(stage, LINKS_PATH)
    if spec.root == "slide_roll":
        UsdGeom.Scope.Define(stage, JOINTS_PATH)


def _write_link(stage: Usd.Stage, spec: EndoscopeSpec, link: int, height: float) -> None:
    """One rigid link: a capsule for contact, with the mass and inertia of a solid cylinder."""
    length, radius, mass = (float(a[link]) for a in (spec.link_length, spec.link_radius, spec.link_mass))
    body = UsdGeom.Xform.Define(stage, f"{LINKS_PATH}/{link_name(link)}")
    body.AddTranslateOp().Set(Gf.Vec3d(0.0, 0.0, height))
    UsdPhysics.RigidBodyAPI.Apply(body.GetPrim())
    _set(body.GetPrim(), "arcgym:length", Sdf.ValueTypeNames.Float, length)
    mass_api = UsdPhysics.MassAPI.Apply(body.GetPrim())
    mass_api.CreateMassAttr(mass)
    mass_api.CreateCenterOfMassAttr(Gf.Vec3f(0.0))
    mass_api.CreateDiagonalInertiaAttr(Gf.Vec3f(*cylinder_inertia(mass, radius, length)))
    mass_api.CreatePrincipalAxesAttr(Gf.Quatf(1.0))
    shape = UsdGeom.Capsule.Define(stage, f"{body.GetPath()}/Shape")
    half_height = capsule_half_height(length, radius, len(spec.link_length))
    shape.CreateAxisAttr(UsdGeom.Tokens.z)
    shape.CreateRadiusAttr(radius)
    shape.CreateHeightAttr(2.0 * half_height)
    shape.CreateExtentAttr([(-radius, -radius, -half_height - radius), (radius, radius, half_height + radius)])
    shape.CreateDisplayColorAttr([(0.05, 0.05, 0.06)])
    UsdPhysics.CollisionAPI.Apply(shape.GetPrim())


def cylinder_inertia(mass: float, radius: float, length: float) -> tuple[float, float, float]:
    """Principal moments of inertia of a solid cylinder along Z about its center [kg m^2]."""
    across = mass * (3.0 * radius**2 + length**2) / 12.0
    return across, across, 0.5 * mass * radius**2


def _write_optics(stage: Usd.Stage, spec: EndoscopeSpec) -> None:
    """Camera and lights, children of the last link."""
    tip = f"{LINKS_PATH}/{link_name(len(spec.link_length) - 1)}"
    camera = UsdGeom.Camera.Define(stage, f"{tip}/Camera")
    x, y, z, w = spec.camera.quaternion
    camera.AddTranslateOp().Set(Gf.Vec3d(*spec.camera.position))
    camera.AddOrientOp().Set(Gf.Quatf(w, x, y, z))
    aperture = 20.0
    half_diagonal = aperture / math.sqrt(2.0)
    camera.CreateHorizontalApertureAttr(aperture)
    camera.CreateVerticalApertureAttr(aperture)
    camera.CreateFocalLengthAttr(half_diagonal / math.tan(0.5 * spec.camera.field_of_view))
    camera.CreateClippingRangeAttr(Gf.Vec2f(*spec.camera.clipping))
    _set(camera.GetPrim(), "arcgym:fieldOfView", Sdf.ValueTypeNames.Float, spec.camera.field_of_view)
    for name, position in zip(("LightLeft", "LightRight"), spec.lights, strict=True):
        light = UsdLux.SphereLight.Define(stage, f"{tip}/{name}")
        light.AddTranslateOp().Set(Gf.Vec3d(*map(float, position)))
        light.CreateRadiusAttr(0.0009)
        light.CreateExtentAttr([(-0.0009,) * 3, (0.0009,) * 3])


def _write_root(stage: Usd.Stage, spec: EndoscopeSpec, height: float) -> None:
    """Return the joint of the first link to the world, free to slide along and roll about Z."""
    joint = UsdPhysics.Joint.Define(stage, ROOT_JOINT_PATH)
    prim = joint.GetPrim()
    joint.CreateBody1Rel().SetTargets([f"{LINKS_PATH}/{link_name(0)}"])
    _write_frames(joint, height, 0.0)
    for axis in ("transX", "transY", "rotX", "rotY"):
        _write_limit(prim, axis, 1.0, -1.0)
    _write_limit(prim, "transZ", -SLIDE_MARGIN, spec.total_length)
    _write_limit(prim, "rotZ", -ROLL_LIMIT, ROLL_LIMIT)
    _write_drive(prim, "transZ", spec.slide_drive, 1.0)
    _write_drive(prim, "rotZ", spec.roll_drive, math.radians(1.0))


def _write_hinge(stage: Usd.Stage, spec: EndoscopeSpec, hinge: int) -> None:
    """Write the hinge between links `hinge` - 1 and `hinge`, whose drives carry the elasticity of the shaft.

    Its axes are joints of the same two links, which Newton's importer merges into one.
    """
    k = hinge - 1
    for axis in (0, 1):
        _write_turn(stage, spec, hinge, axis, spec.hinge_stiffness[k], spec.hinge_limit[k, axis])
    if spec.twist_stiffness[k] > 0.0:
        _write_turn(stage, spec, hinge, 2, spec.twist_stiffness[k], TWIST_LIMIT)


def _write_turn(stage: Usd.Stage, spec: EndoscopeSpec, hinge: int, axis: int, stiffness: float, limit: float) -> None:
    """Write one elastic axis of a hinge, with its drive [N m/rad] and its stops [rad]."""
    joint = UsdPhysics.RevoluteJoint.Define(stage, f"{JOINTS_PATH}/{turn_name(hinge, axis)}")
    joint.CreateBody0Rel().SetTargets([f"{LINKS_PATH}/{link_name(hinge - 1)}"])
    joint.CreateBody1Rel().SetTargets([f"{LINKS_PATH}/{link_name(hinge)}"])
    joint.CreateAxisAttr("XYZ"[axis])
    _write_frames(joint, 0.5 * spec.link_length[hinge - 1], -0.5 * spec.link_length[hinge])
    joint.CreateLowerLimitAttr(-math.degrees(limit))
    joint.CreateUpperLimitAttr(math.degrees(limit))
    damping = spec.damping_time * float(stiffness)
    _write_drive(joint.GetPrim(), "angular", DriveSpec(float(stiffness), damping), math.radians(1.0))
    stop = math.radians(1.0) * spec.stop_ratio * float(stiffness)
    joint.GetPrim().AddAppliedSchema("NewtonJointAPI")
    for attribute, value in (
        ("newton:armature", spec.armature_time * damping),
        ("newton:limitStiffness", stop),
        ("newton:limitDamping", spec.stop_damping_time * stop),
    ):
        _set(joint.GetPrim(), attribute, Sdf.ValueTypeNames.Float, value)


def _write_frames(joint: UsdPhysics.Joint, height0: float, height1: float) -> None:
    """Put the joint's frames on the Z axes of its two bodies, `height0` and `height1` from their centers [m]."""
    joint.CreateLocalPos0Attr(Gf.Vec3f(0.0, 0.0, float(height0)))
    joint.CreateLocalPos1Attr(Gf.Vec3f(0.0, 0.0, float(height1)))
    joint.CreateLocalRot0Attr(Gf.Quatf(1.0))
    joint.CreateLocalRot1Attr(Gf.Quatf(1.0))


def _write_limit(prim: Usd.Prim, axis: str, low: float, high: float) -> None:
    """Range of one axis of a joint; low > high locks it."""
    limit = UsdPhysics.LimitAPI.Apply(prim, axis)
    limit.CreateLowAttr(low)
    limit.CreateHighAttr(high)


def _write_drive(prim: Usd.Prim, axis: str, spec: DriveSpec | None, unit: float) -> None:
    """Drive of one axis, if any; `unit` is 1 for meters, one degree in radians for angles: USD counts per degree."""
    if spec is None:
        return
    drive = UsdPhysics.DriveAPI.Apply(prim, axis)
    drive.CreateTypeAttr(UsdPhysics.Tokens.force)
    drive.CreateTargetPositionAttr(0.0)
    drive.CreateStiffnessAttr(spec.stiffness * unit)
    drive.CreateDampingAttr(spec.damping * unit)
    if math.isfinite(spec.max_force):
        drive.CreateMaxForceAttr(spec.max_force)


def _set(prim: Usd.Prim, name: str, value_type: Sdf.ValueTypeName, value: object) -> None:
    """Create an attribute and set it; written alike whether or not Newton's USD schemas are registered."""
    prim.CreateAttribute(name, value_type, custom=False).Set(value)
