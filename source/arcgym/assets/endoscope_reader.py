# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Reads the USD stage of an endoscope, and says what is wrong with it and how to mend it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from arcgym.anatomy.stage import StageError, open_stage
from arcgym.assets.endoscope_spec import (
    CameraSpec,
    DriveSpec,
    RootKind,
    capsule_half_height,
    hinge_levers,
)
from arcgym.assets.endoscope_writer import (
    ENDOSCOPE_PATH,
    JOINTS_PATH,
    LINKS_PATH,
    ROOT_JOINT_PATH,
    TURNS,
    turn_name,
)


@dataclass(frozen=True)
class EndoscopeStage:
    """What the simulation and the sensors need to know of an endoscope with L links, read from its stage."""

    path: Path
    """File it was read from."""
    name: str
    """Name of the file without its suffix."""
    root: RootKind
    """Joint of the first link to the world: ``free`` (7 coordinates) or ``slide_roll`` (2)."""
    link_length: np.ndarray
    """Length of each link, base first [m], shape (L,)."""
    link_radius: np.ndarray
    """Radius of each link [m], shape (L,)."""
    link_mass: np.ndarray
    """Real mass of each link [kg], shape (L,)."""
    hinge_stiffness: np.ndarray
    """Stiffness of hinge i about X and Y [N m/rad], at index i - 1: it joins links i - 1 and i, shape (L - 1, 2)."""
    hinge_damping: np.ndarray
    """Damping of each hinge [N m s/rad], shape (L - 1, 2)."""
    hinge_limit: np.ndarray
    """Largest pitch and yaw of each hinge to either side [rad], shape (L - 1, 2)."""
    hinge_armature: np.ndarray
    """Armature inertia of each hinge [kg m^2], shape (L - 1, 2)."""
    stop_stiffness: np.ndarray
    """Stiffness of each hinge beyond its limits [N m/rad], shape (L - 1, 2)."""
    twist_stiffness: np.ndarray
    """Stiffness of the twist at each hinge [N m/rad], 0 at those that do not twist, shape (L - 1,)."""
    twist_damping: np.ndarray
    """Damping of the twist at each hinge [N m s/rad], shape (L - 1,)."""
    twist_limit: np.ndarray
    """Largest twist at each hinge to either side [rad], shape (L - 1,)."""
    slide_drive: DriveSpec | None
    """Drive of the root along Z; None for a free root."""
    roll_drive: DriveSpec | None
    """Drive of the root about Z; None for a free root."""
    bending_links: int
    """Number of distal links whose hinges the control wheels bend."""
    camera: CameraSpec
    """Camera in the frame of the last link."""
    lights: np.ndarray
    """Positions of the lights in the frame of the last link [m], shape (2, 3)."""

    @property
    def num_links(self) -> int:
        """Number of links L."""
        return len(self.link_length)

    @property
    def total_length(self) -> float:
        """Sum of the link lengths [m]."""
        return float(self.link_length.sum())

    @property
    def root_coords(self) -> int:
        """Joint coordinates of the root."""
        return 2 if self.root == "slide_roll" else 7

    @property
    def lever(self) -> np.ndarray:
        """Length of shaft that each hinge stands for [m], shape (L - 1,)."""
        return hinge_levers(self.link_length, self.root)

    @property
    def turns(self) -> list[tuple[int, int]]:
        """(hinge number, axis 0 to 2 for X to Z) of every joint coordinate behind the root's."""
        hinges = enumerate(self.twist_stiffness, start=1)
        return [(hinge, axis) for hinge, k in hinges for axis in range(3 if k > 0.0 else 2)]

    @property
    def bend_coords(self) -> np.ndarray:
        """Joint coordinates of the pitch and yaw of each hinge, shape (L - 1, 2)."""
        return self.root_coords + np.flatnonzero([axis < 2 for _, axis in self.turns]).reshape(-1, 2)

    def by_turn(self, bend: np.ndarray, twist: np.ndarray) -> np.ndarray:
        """Values of the hinges' bending, shape (L - 1, 2), and twist, shape (L - 1,), in the order of :attr:`turns`."""
        return np.array([twist[hinge - 1] if axis == 2 else bend[hinge - 1, axis] for hinge, axis in self.turns])


def read_endoscope(path: str | Path) -> EndoscopeStage:
    """Read and check the endoscope stage at `path`.

    Raises:
        StageError: If the file is missing or lacks something; names file, prim, attribute and the mend.
    """
    return _Reader(Path(path)).read()


def _pairs(hinges: Sequence[Sequence[Usd.Prim]], value: Callable[[Usd.Prim], float]) -> np.ndarray:
    """Return a number of the pitch and of the yaw of every hinge, shape (L - 1, 2)."""
    return np.array([[value(turn) for turn in hinge] for hinge in hinges]).reshape(-1, 2)


def _list_files(folder: Path) -> str:
    near = ", ".join(sorted(file.name for file in folder.glob("*.usd*"))) or "no USD file"
    return f"The folder {folder} has {near}."


class _Reader:
    """An open stage and the checks of its values."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.usd = open_stage(  # no rescaling: it would need masses, inertias and drives, too
            path,
            missing=lambda: _list_files(path.parent),
            meters="Export the stage in meters (metersPerUnit 1).",
            up="Export the stage with Z up.",
        )

    def read(self) -> EndoscopeStage:
        """Check the layout, then collect the values."""
        scope = self._prim(ENDOSCOPE_PATH, UsdPhysics.ArticulationRootAPI)
        links = [prim for prim in self._prim(LINKS_PATH).GetChildren() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
        if not links:
            raise self._error(LINKS_PATH, "apiSchemas", "no child has PhysicsRigidBodyAPI", "Apply it to every link.")
        length = np.array([self._number(prim, "arcgym:length") for prim in links])
        shapes = [self._prim(f"{prim.GetPath()}/Shape", UsdPhysics.CollisionAPI) for prim in links]
        radius = np.array([self._number(shape, "radius") for shape in shapes])
        self._check_shapes(shapes, length, radius)
        hinges = [[self._turn(links, length, hinge, axis) for axis in (0, 1)] for hinge in range(1, len(links))]
        twists = [self._twist(links, length, hinge) for hinge in range(1, len(links))]
        twist = np.array([(*self._hinge_drive(t), self._hinge_limit(t)) if t else (0.0,) * 3 for t in twists])
        twist = twist.reshape(-1, 3)
        slide, roll = self._root_drives(links[0])
        return EndoscopeStage(
            path=self.path,
            name=self.path.stem,
            root="slide_roll" if slide else "free",
            link_length=length,
            link_radius=radius,
            link_mass=np.array([self._mass(prim) for prim in links]),
            hinge_stiffness=_pairs(hinges, lambda hinge: self._hinge_drive(hinge)[0]),
            hinge_damping=_pairs(hinges, lambda hinge: self._hinge_drive(hinge)[1]),
            hinge_limit=_pairs(hinges, self._hinge_limit),
            hinge_armature=_pairs(hinges, lambda hinge: self._number(hinge, "newton:armature")),
            stop_stiffness=np.degrees(_pairs(hinges, lambda hinge: self._number(hinge, "newton:limitStiffness"))),
            twist_stiffness=twist[:, 0],
            twist_damping=twist[:, 1],
            twist_limit=twist[:, 2],
            slide_drive=slide,
            roll_drive=roll,
            bending_links=int(self._value(scope, "arcgym:bendingLinks")),
            camera=self._camera(links[-1]),
            lights=self._lights(links[-1]),
        )

    def _check_shapes(self, shapes: Sequence[Usd.Prim], length: np.ndarray, radius: np.ndarray) -> None:
        """Each link must collide as a capsule along Z, as high as its length asks for."""
        for shape, link_length, link_radius in zip(shapes, length, radius, strict=True):
            if not shape.IsA(UsdGeom.Capsule) or self._value(shape, "axis") != UsdGeom.Tokens.z:
                raise self._error(shape, "axis", "not a Capsule along Z", "Make the shape a Capsule with axis 'Z'.")
            height = 2.0 * capsule_half_height(link_length, link_radius, len(length))
            self._expect(shape, "height", self._number(shape, "height"), height, "arcgym:length of its link")

    def _mass(self, link: Usd.Prim) -> float:
        mass = self._number(link, "physics:mass")
        if mass <= 0.0:
            raise self._error(link, "physics:mass", f"is {mass:g}", "Set the real mass of the link in kilograms.")
        return mass

    def _twist(self, links: Sequence[Usd.Prim], length: np.ndarray, hinge: int) -> Usd.Prim | None:
        """Return the prim of the twist at hinge number `hinge`, or None if it does not twist."""
        there = self.usd.GetPrimAtPath(f"{JOINTS_PATH}/{turn_name(hinge, 2)}")
        return self._turn(links, length, hinge, 2) if there else None

    def _turn(self, links: Sequence[Usd.Prim], length: np.ndarray, hinge: int, axis: int) -> Usd.Prim:
        """Return a joint of hinge number `hinge`, checked to join its two links end to end about the right axis."""
        prim = self._prim(f"{JOINTS_PATH}/{turn_name(hinge, axis)}", UsdPhysics.RevoluteJoint)
        self._expect_body(prim, "physics:body0", links[hinge - 1])
        self._expect_body(prim, "physics:body1", links[hinge])
        for attribute, end in (("physics:localPos0", length[hinge - 1]), ("physics:localPos1", -length[hinge])):
            self._expect(prim, attribute, self._value(prim, attribute)[2], 0.5 * end, "arcgym:length of its link")
        if self._value(prim, "physics:axis") != "XYZ"[axis]:
            found = f"is {self._value(prim, 'physics:axis')}"
            raise self._error(prim, "physics:axis", found, f"Set it to '{'XYZ'[axis]}', as {TURNS[axis]} asks for.")
        return prim

    def _hinge_drive(self, hinge: Usd.Prim) -> tuple[float, float]:
        """Stiffness [N m/rad] and damping [N m s/rad] of a hinge."""
        drive = self._drive(hinge, "angular", math.degrees(1.0))
        return drive.stiffness, drive.damping

    def _hinge_limit(self, hinge: Usd.Prim) -> float:
        """Largest angle of a hinge [rad], the same to either side."""
        lower, upper = self._number(hinge, "physics:lowerLimit"), self._number(hinge, "physics:upperLimit")
        self._expect(hinge, "physics:lowerLimit", lower, -upper, "minus physics:upperLimit")
        return math.radians(upper)

    def _root_drives(self, base: Usd.Prim) -> tuple[DriveSpec | None, DriveSpec | None]:
        """Slide and roll drive of the root joint; None twice when the base is free."""
        if not self.usd.GetPrimAtPath(ROOT_JOINT_PATH):
            return None, None
        prim = self._prim(ROOT_JOINT_PATH, UsdPhysics.Joint)
        self._expect_body(prim, "physics:body1", base)
        for axis in ("transZ", "rotZ"):
            low, high = (self._number(prim, f"limit:{axis}:physics:{end}") for end in ("low", "high"))
            if low >= high:
                found = f"range {low:g} to {high:g} locks the axis"
                raise self._error(prim, f"limit:{axis}:physics:low", found, "Apply PhysicsLimitAPI with low < high.")
        return self._drive(prim, "transZ", 1.0), self._drive(prim, "rotZ", math.degrees(1.0))

    def _drive(self, prim: Usd.Prim, axis: str, unit: float) -> DriveSpec:
        """Drive of one axis of a joint in SI units; `unit` turns the stage's gains, per degree for angles."""
        if not prim.HasAPI(UsdPhysics.DriveAPI, axis):
            raise self._error(prim, "apiSchemas", f"no PhysicsDriveAPI:{axis}", "Apply it with stiffness and damping.")
        stiffness, damping = (self._number(prim, f"drive:{axis}:physics:{gain}") for gain in ("stiffness", "damping"))
        return DriveSpec(stiffness * unit, damping * unit, self._number(prim, f"drive:{axis}:physics:maxForce"))

    def _camera(self, tip: Usd.Prim) -> CameraSpec:
        prim = self._prim(f"{tip.GetPath()}/Camera", UsdGeom.Camera)
        near, far = self._value(prim, "clippingRange")
        field_of_view = self._number(prim, "arcgym:fieldOfView")
        if not 0.0 < field_of_view < math.pi:
            found = f"is {field_of_view:g}"
            raise self._error(prim, "arcgym:fieldOfView", found, "Give the diagonal angle in radians, below pi.")
        pose = self._pose(prim)
        rotation = pose.ExtractRotationQuat()
        quaternion = (*rotation.GetImaginary(), rotation.GetReal())
        return CameraSpec(tuple(pose.ExtractTranslation()), quaternion, field_of_view, (near, far))

    def _lights(self, tip: Usd.Prim) -> np.ndarray:
        """Positions of the two lights [m], shape (2, 3)."""
        prims = [self._prim(f"{tip.GetPath()}/{name}") for name in ("LightLeft", "LightRight")]
        return np.array([self._pose(prim).ExtractTranslation() for prim in prims])

    def _pose(self, prim: Usd.Prim) -> Gf.Matrix4d:
        return UsdGeom.Xformable(prim).GetLocalTransformation()

    def _prim(self, prim_path: str, schema: Any = None) -> Usd.Prim:
        """Return the prim at `prim_path`, checked to have the API schema or to be of the type `schema`."""
        prim = self.usd.GetPrimAtPath(prim_path)
        if not prim:
            raise self._error(prim_path, "", "no such prim", "Write the stage with arcgym's write_endoscope.")
        if schema is None or prim.IsA(schema) or (issubclass(schema, Usd.APISchemaBase) and prim.HasAPI(schema)):
            return prim
        raise self._error(prim, "apiSchemas", f"no {schema.__name__}", f"Apply or use {schema.__name__} there.")

    def _value(self, prim: Usd.Prim, attribute: str) -> Any:
        value = prim.GetAttribute(attribute).Get() if prim.HasAttribute(attribute) else None
        if value is None:
            raise self._error(prim, attribute, "has no value", "Author the attribute.")
        return value

    def _number(self, prim: Usd.Prim, attribute: str) -> float:
        return float(self._value(prim, attribute))

    def _expect(self, prim: Usd.Prim, attribute: str, found: float, expected: float, why: str) -> None:
        """Compare a length [m] or angle [deg] with what `why` asks for, within the precision of a float."""
        if not math.isclose(found, expected, rel_tol=1e-4, abs_tol=1e-6):
            raise self._error(prim, attribute, f"is {found:g}", f"Set it to {expected:g} ({why}).")

    def _expect_body(self, prim: Usd.Prim, relation: str, link: Usd.Prim) -> None:
        targets = [str(target) for target in prim.GetRelationship(relation).GetTargets()]
        if targets != [str(link.GetPath())]:
            raise self._error(prim, relation, f"targets {targets}", f"Target {link.GetPath()}.")

    def _error(self, prim: Usd.Prim | str, attribute: str, found: str, mend: str) -> StageError:
        where = prim if isinstance(prim, str) else str(prim.GetPath())
        return StageError(self.path, where, attribute, found, mend)
