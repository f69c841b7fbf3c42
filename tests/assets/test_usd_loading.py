# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Stages loaded by Newton: complete, in order, in several worlds; the loaded scope bends as a beam should."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdPhysics, UsdShade, Vt
from tiny import write_tiny_colon
from tiny_scope import tiny_scope_spec, write_tiny_scope

from arcgym.anatomy import StageError, read_colon
from arcgym.assets.endoscope_spec import SHAFT_LINK
from arcgym.assets.endoscope_stage import EndoscopeStage, read_endoscope, write_endoscope
from arcgym.assets.usd_loading import PARTICLE_RADIUS, add_colon_usd, add_endoscope_usd

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton
import warp as wp
from newton import Model, ModelBuilder
from newton.solvers import SolverMuJoCo

DT = 1.0 / 960.0


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> ModelBuilder:
    """A tiny colon and a tiny proximal scope of 6 links in one builder, colored."""
    folder = tmp_path_factory.mktemp("world")
    colon, scope = write_tiny_colon(folder), write_tiny_scope(folder / "scope.usda")
    builder = ModelBuilder(gravity=(0.0, 0.0, 0.0))
    add_colon_usd(builder, colon, read_colon(colon))
    add_endoscope_usd(builder, scope, read_endoscope(scope))
    builder.color()
    return builder


@pytest.fixture(scope="module")
def two_worlds(world: ModelBuilder) -> Model:
    return replicated(world, 2)


def replicated(world: ModelBuilder, count: int) -> Model:
    builder = ModelBuilder(gravity=(0.0, 0.0, 0.0))
    builder.replicate(world, count)
    return builder.finalize(device="cpu")


def test_wall_particles_are_the_stage_s_vertices(tmp_path: Path) -> None:
    path = write_tiny_colon(tmp_path)
    stage, builder = read_colon(path), ModelBuilder()
    assert add_colon_usd(builder, path, stage) == range(0, len(stage.wall.points))
    np.testing.assert_allclose(np.array(builder.particle_q), stage.wall.points, atol=1e-7)
    assert set(builder.particle_radius) == {PARTICLE_RADIUS}
    fixed = stage.wall.anchor == 2
    assert fixed.any() and ((np.array(builder.particle_mass) == 0.0) == fixed).all()


@pytest.mark.parametrize(
    ("kind", "coords", "dofs"), [("capsule", 7, 6), ("magnetic", 2 + 11, 2 + 11), ("proximal", 2 + 11, 2 + 11)]
)
def test_root_coordinates_come_first(tmp_path: Path, kind: str, coords: int, dofs: int) -> None:
    path = write_tiny_scope(tmp_path / "scope.usda", kind)
    stage, builder = read_endoscope(path), ModelBuilder()
    indices = add_endoscope_usd(builder, path, stage)
    assert len(indices.coords) == coords and len(indices.dofs) == dofs
    assert indices.bodies == indices.joints == indices.shapes == range(0, stage.num_links)
    assert not builder.shape_collision_filter_pairs


def test_indices_of_world_w_are_w_times_count_plus_i(world: ModelBuilder, two_worlds: Model) -> None:
    vertices, links = world.particle_count, world.body_count
    points = two_worlds.particle_q.numpy().reshape(2, vertices, 3)
    np.testing.assert_array_equal(points[0], points[1])
    assert (two_worlds.particle_world.numpy() == np.repeat([0, 1], vertices)).all()
    assert (two_worlds.body_world.numpy() == np.repeat([0, 1], links)).all()
    assert two_worlds.body_label[:links] == two_worlds.body_label[links:]


def test_coloring_one_world_colors_all(world: ModelBuilder, two_worlds: Model) -> None:
    color = np.full(two_worlds.particle_count, -1)
    for index, group in enumerate(two_worlds.particle_color_groups):
        color[group.numpy()] = index
    corners = np.sort(color[two_worlds.tet_indices.numpy().reshape(-1, 4)], axis=1)
    assert (color >= 0).all() and (np.diff(corners, axis=1) > 0).all()
    assert len(two_worlds.particle_color_groups) == len(world.particle_color_groups)


def override(usd: Usd.Stage, prim: str, attribute: str, value: object) -> None:
    usd.GetPrimAtPath(prim).GetAttribute(attribute).Set(value)


def swap_corners_of_first_tet(usd: Usd.Stage) -> None:
    attribute = UsdGeom.TetMesh(usd.GetPrimAtPath("/Colon/Wall")).GetTetVertexIndicesAttr()
    tets = np.array(attribute.Get())
    tets[0] = tets[0][[1, 0, 2, 3]]
    attribute.Set(Vt.Vec4iArray.FromNumpy(tets))


def unbind_tissue(usd: Usd.Stage) -> None:
    UsdShade.MaterialBindingAPI(usd.GetPrimAtPath("/Colon/Wall")).UnbindDirectBinding("physics")


COLON_DEFECTS: dict[str, tuple[Callable[[Usd.Stage], object], list[str]]] = {
    "inverted": (swap_corners_of_first_tet, ["/Colon/Wall", "tetVertexIndices", "Swap two vertices"]),
    "unbound": (unbind_tissue, ["/Colon/Tissue", "physics:youngsModulus", "Bind"]),
    "softer": (
        lambda usd: override(usd, "/Colon/Tissue", "physics:youngsModulus", 1.0e5),
        ["/Colon/Tissue", "physics:youngsModulus", "33557"],
    ),
    "moved": (
        lambda usd: UsdGeom.Xformable(usd.GetPrimAtPath("/Colon")).AddTranslateOp().Set((0.0, 0.0, 0.1)),
        ["/Colon/Wall", "points", "0.1 m"],
    ),
}


@pytest.mark.parametrize("defect", COLON_DEFECTS)
def test_colon_that_newton_takes_differently(tmp_path: Path, defect: str) -> None:
    path = write_tiny_colon(tmp_path)
    stage, usd = read_colon(path), Usd.Stage.Open(str(path))
    spoil, words = COLON_DEFECTS[defect]
    spoil(usd)
    usd.GetRootLayer().Export(str(tmp_path / "spoilt.usda"))
    with pytest.raises(StageError) as error:
        add_colon_usd(ModelBuilder(), tmp_path / "spoilt.usda", stage)
    assert all(word in str(error.value) for word in ["spoilt.usda", *words]), str(error.value)


SCOPE_DEFECTS: dict[str, tuple[Callable[[Usd.Stage], object], list[str]]] = {
    "slide_without_range": (
        lambda usd: usd.GetPrimAtPath("/Endoscope/Joints/root").RemoveAPI(UsdPhysics.LimitAPI, "transZ"),
        ["/Endoscope", "PhysicsLimitAPI"],
    ),
    "weak_hinge": (
        lambda usd: override(usd, "/Endoscope/Joints/bend_x_02", "drive:angular:physics:stiffness", 1.0e-3),
        ["bend_x_02", "stiffness", "0.0572958", f"{0.025 / (2 * SHAFT_LINK):g}"],
    ),
    "heavy_link": (lambda usd: override(usd, "/Endoscope/Links/link_03", "physics:mass", 1.0), ["link_03", "mass"]),
    "thin_link": (lambda usd: override(usd, "/Endoscope/Links/link_03/Shape", "radius", 0.001), ["Shape", "radius"]),
    "wide_limit": (
        lambda usd: override(usd, "/Endoscope/Joints/bend_x_05", "physics:upperLimit", 90.0),
        ["bend_x_05", "physics:upperLimit"],
    ),
    "disabled_hinge": (
        lambda usd: override(usd, "/Endoscope/Joints/bend_x_03", "physics:jointEnabled", False),
        ["/Endoscope/Joints", "REVOLUTE"],
    ),
    "weak_push": (
        lambda usd: override(usd, "/Endoscope/Joints/root", "drive:transZ:physics:maxForce", 3.0),
        ["/Endoscope/Joints/root", "maxForce", "43"],
    ),
}


@pytest.mark.parametrize("defect", SCOPE_DEFECTS)
def test_scope_that_newton_takes_differently(tmp_path: Path, defect: str) -> None:
    path = write_tiny_scope(tmp_path / "scope.usda")
    stage, usd = read_endoscope(path), Usd.Stage.Open(str(path))
    spoil, words = SCOPE_DEFECTS[defect]
    spoil(usd)
    usd.GetRootLayer().Save()
    with pytest.raises(StageError) as error:
        add_endoscope_usd(ModelBuilder(), path, stage)
    assert all(word in str(error.value) for word in ["scope.usda", *words]), str(error.value)


class ScopeRun:
    """A scope alone in `worlds` worlds, stepped by MuJoCo with two steps in a captured graph."""

    def __init__(self, path: Path, worlds: int = 1) -> None:
        self.stage: EndoscopeStage = read_endoscope(path)
        builder = ModelBuilder(gravity=(0.0, 0.0, 0.0))
        SolverMuJoCo.register_custom_attributes(builder)
        add_endoscope_usd(builder, path, self.stage)
        self.model = replicated(builder, worlds)
        options = {"disable_contacts": True, "integrator": "implicitfast", "iterations": 10, "ls_iterations": 5}
        self.solver = SolverMuJoCo(self.model, njmax=100, nconmax=1, **options)
        self.states = [self.model.state(), self.model.state()]
        self.control = self.model.control()
        newton.eval_fk(self.model, self.model.joint_q, self.model.joint_qd, self.states[0])

    def _two_steps(self) -> None:
        for here, there in (self.states, self.states[::-1]):
            self.solver.step(here, there, self.control, None, DT)

    def run(self, seconds: float) -> np.ndarray:
        """Joint coordinates after `seconds` more, shape (worlds, J)."""
        self._two_steps()
        with wp.ScopedCapture(device="cpu") as capture:
            self._two_steps()
        for _ in range(round(seconds / DT) // 2):
            wp.capture_launch(capture.graph)
        return self.states[0].joint_q.numpy().reshape(self.model.world_count, -1)


def test_cantilever_bends_as_euler_bernoulli(tmp_path: Path) -> None:
    """0.05 N across the tip of 8 links of 20 mm, EI 0.025 N m^2; world 0 along Y, world 1 along X.

    Hinge 1 at the rigid first link is 7 links from the tip and stands for half a link, 2 k; the others, 6 to 1 links
    away, have k = 1.25 N m/rad: (7^2 / 2 + 91) (20 mm)^2 F / k = 1.848 mm. Euler-Bernoulli: F (7 x 20 mm)^3 / (3 EI) =
    1.829 mm, 1 % less.
    """
    links, length, rigidity, force = 8, 0.020, 0.025, 0.05
    spec = replace(
        tiny_scope_spec("proximal", links),
        link_length=np.full(links, length),
        link_mass=np.full(links, 0.004),
        bending_rigidity=np.full(links - 1, rigidity),
    )
    scope = ScopeRun(write_endoscope(spec, tmp_path / "beam.usda"), worlds=2)
    wrench = np.zeros((2, links, 6), np.float32)
    half = np.array([0.0, 0.0, length / 2])
    for world, across in enumerate(([0.0, force, 0.0], [force, 0.0, 0.0])):
        wrench[world, -1] = np.r_[across, np.cross(half, across)]
    for state in scope.states:
        state.body_f.assign(wrench.reshape(-1, 6))
    angles = scope.run(1.0)
    bends = [angles[world, scope.stage.bend_coords[:, world]] for world in (0, 1)]
    to_tip = length * np.arange(links - 1, 0, -1)
    discrete = force * length / rigidity * ((to_tip[1:] ** 2).sum() + 0.5 * to_tip[0] ** 2)
    beam = force * (7 * length) ** 3 / (3 * rigidity)
    assert discrete == pytest.approx(1.848e-3, rel=1e-3)
    np.testing.assert_allclose(np.abs(bends) @ to_tip, discrete, rtol=2e-3)
    assert discrete == pytest.approx(beam, rel=0.02)


def test_hinge_stops_at_its_limit(tmp_path: Path) -> None:
    """Driven to 3 rad, hinge and stop (20 times as stiff) balance at (3 + 20 limit) / 21."""
    scope = ScopeRun(write_tiny_scope(tmp_path / "scope.usda"))
    target = scope.control.joint_target_q.numpy()
    target[-1] = 3.0
    scope.control.joint_target_q.assign(target)
    limit = scope.stage.hinge_limit[-1, 1]
    assert scope.run(0.5)[0, -1] == pytest.approx((3.0 + 20.0 * limit) / 21.0, rel=0.01)


def test_push_is_limited(tmp_path: Path) -> None:
    """With its target 1 m ahead the slide (2000 N/m) pushes with 43 N, not 2000 N: at rest against 43 N."""
    scope = ScopeRun(write_tiny_scope(tmp_path / "scope.usda"))
    target = scope.control.joint_target_q.numpy()
    target[0] = 1.0
    scope.control.joint_target_q.assign(target)
    wrench = np.zeros((scope.stage.num_links, 6), np.float32)
    wrench[0, 2] = -43.0
    for state in scope.states:
        state.body_f.assign(wrench)
    assert scope.run(0.1)[0, 0] == pytest.approx(0.0, abs=1e-4)
