# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The shipped endoscopes: their numbers, their files, and what is said of a broken one."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdPhysics, UsdValidation
from tiny_scope import write_tiny_scope

from arcgym.anatomy import StageError
from arcgym.assets.endoscope_spec import (
    SHAFT_LIMIT,
    SHAFT_LINK,
    TIP_LINK,
    TORSIONAL_RIGIDITY,
    EndoscopeSpec,
    endoscope_specs,
    hinge_levers,
    magnetic_spec,
    proximal_spec,
    shared_stiffness,
)
from arcgym.assets.endoscope_stage import author_endoscopes, read_endoscope, write_endoscope
from arcgym.envs.provenance import stage_hash
from arcgym.recordings.restoring import REWRITTEN
from arcgym.utils.paths import ASSETS_ENV, assets_dir

SHIPPED = Path(__file__).parents[2] / "assets" / "usd" / "endoscopes"
each_spec = pytest.mark.parametrize("spec", endoscope_specs(), ids=lambda spec: spec.name)


@each_spec
def test_round_trip(spec: EndoscopeSpec) -> None:
    stage = read_endoscope(SHIPPED / f"{spec.name}.usda")
    assert (stage.name, stage.root) == (spec.name, spec.root)
    assert stage.bending_links == spec.bending_links
    for name in ("link_length", "link_radius", "link_mass", "lights"):
        np.testing.assert_allclose(getattr(stage, name), getattr(spec, name), rtol=1e-6, err_msg=name)
    for name in ("hinge_stiffness", "hinge_damping", "hinge_armature", "stop_stiffness"):
        both = np.repeat(getattr(spec, name)[:, None], 2, axis=1)
        np.testing.assert_allclose(getattr(stage, name), both, rtol=1e-6, err_msg=name)
    for name in ("hinge_limit", "twist_stiffness", "lever"):
        np.testing.assert_allclose(getattr(stage, name), getattr(spec, name), rtol=1e-6, err_msg=name)
    assert stage.camera.position == pytest.approx(spec.camera.position)
    assert stage.camera.quaternion == pytest.approx(spec.camera.quaternion)
    assert stage.camera.field_of_view == pytest.approx(math.radians(150.0))


@each_spec
def test_usd_validators_find_nothing(spec: EndoscopeSpec) -> None:
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    stage = Usd.Stage.Open(str(SHIPPED / f"{spec.name}.usda"))
    errors = UsdValidation.ValidationContext(validators).Validate(stage)
    assert [error.GetErrorAsString() for error in errors] == []


def test_committed_files_are_what_the_code_writes(tmp_path: Path) -> None:
    author_endoscopes(tmp_path)
    made = sorted(tmp_path.iterdir())
    assert [path.name for path in made] == sorted(path.name for path in SHIPPED.iterdir())
    for path in made:
        layers = [Sdf.Layer.FindOrOpen(str(folder / path.name)) for folder in (tmp_path, SHIPPED)]
        assert layers[0].ExportToString() == layers[1].ExportToString(), path.name


def test_a_shipped_shaft_is_a_short_text_over_the_whole_stage(tmp_path: Path) -> None:
    """Both layers together say what one text file of the same specification says."""
    alone = Usd.Stage.Open(str(write_endoscope(magnetic_spec(), tmp_path / "magnetic.usda")))
    assert (SHIPPED / "magnetic.usda").stat().st_size < 3000
    layered = Usd.Stage.Open(str(SHIPPED / "magnetic.usda"))
    assert layered.Flatten(False).ExportToString() == alone.Flatten(False).ExportToString()


def test_recordings_know_a_shaft_from_before_its_stage_had_two_layers(tmp_path: Path) -> None:
    texts = [write_endoscope(spec, tmp_path / f"{spec.name}.usda") for spec in (magnetic_spec(), proximal_spec())]
    assert {stage_hash(SHIPPED / text.name): stage_hash(text) for text in texts} == REWRITTEN


def test_proximal_dimensions() -> None:
    """0.2 kg/m and more than 1.4 m; the ten hinges of the bending section share 180 degrees, and 160 sideways."""
    spec = proximal_spec()
    assert spec.total_length > 1.4
    assert spec.link_mass.sum() == pytest.approx(0.2 * spec.total_length)
    assert spec.hinge_stiffness[20] == pytest.approx(0.025 / SHAFT_LINK)
    assert spec.hinge_stiffness[-1] == pytest.approx(0.012 / TIP_LINK)
    np.testing.assert_allclose(spec.hinge_limit[-10:].sum(axis=0), np.radians([180, 160]))


def test_shaft_follows_a_bend_of_15_millimeters() -> None:
    """Chords of 12.5 mm on a circle of radius 15 mm turn by 2 asin(12.5 / 30) = 0.86 rad each."""
    turn = 2.0 * math.asin(0.5 * SHAFT_LINK / 0.015)
    assert turn == pytest.approx(0.86, abs=0.001)
    assert turn < SHAFT_LIMIT


def test_hinges_stand_for_half_of_their_links_but_for_a_driven_base() -> None:
    lengths = np.array([0.2, 0.02, 0.04])
    np.testing.assert_allclose(hinge_levers(lengths, "slide_roll"), [0.01, 0.03])
    np.testing.assert_allclose(hinge_levers(lengths, "free"), [0.11, 0.03])


def test_twist_of_the_whole_shaft_is_that_of_its_rigidity() -> None:
    """Every fourth hinge twists; in series they are as compliant as all from the base to the last link's center."""
    spec = proximal_spec()
    stiffness = spec.twist_stiffness
    twists = np.arange(1, len(stiffness) + 1) % 4 == 0
    assert (stiffness[~twists] == 0.0).all() and (stiffness[twists] > 0.0).all()
    length = spec.total_length - spec.link_length[0] - 0.5 * spec.link_length[-1]
    assert (1.0 / stiffness[twists]).sum() == pytest.approx(length / TORSIONAL_RIGIDITY)
    assert stiffness[23] == pytest.approx(TORSIONAL_RIGIDITY / (4 * SHAFT_LINK))


def test_hinges_behind_the_last_that_twists_go_to_it() -> None:
    # Compliances 1, 2 and 4 rad/(N m): the second hinge takes over all.
    stiffness = shared_stiffness(np.array([1.0, 2.0, 4.0]), np.array([False, True, False]))
    np.testing.assert_allclose(stiffness, [0.0, 1.0 / 7.0, 0.0])


def test_magnetic_head_is_stiffer_than_its_tether() -> None:
    spec = magnetic_spec()
    assert spec.bending_links == 0
    assert spec.bending_rigidity[-2:] == pytest.approx(0.025) and spec.bending_rigidity[:-2] == pytest.approx(0.001)
    assert list(2000 * spec.link_radius[-4:]) == pytest.approx([8.0, 13.2, 13.2, 13.2])


@each_spec
def test_rest_pose_has_its_tip_two_centimeters_in(spec: EndoscopeSpec) -> None:
    usd = Usd.Stage.Open(str(SHIPPED / f"{spec.name}.usda"))
    links = usd.GetPrimAtPath("/Endoscope/Links").GetChildren()
    centers = [UsdGeom.Xformable(link).GetLocalTransformation().ExtractTranslation()[2] for link in links]
    assert centers[-1] + spec.link_length[-1] / 2 == pytest.approx(0.02)
    assert centers[0] - spec.link_length[0] / 2 == pytest.approx(0.02 - spec.total_length)


@each_spec
def test_camera_looks_along_the_link_from_within_the_tip(spec: EndoscopeSpec) -> None:
    usd = Usd.Stage.Open(str(SHIPPED / f"{spec.name}.usda"))
    tip = usd.GetPrimAtPath("/Endoscope/Links").GetChildren()[-1].GetPath()
    pose = UsdGeom.Xformable(usd.GetPrimAtPath(f"{tip}/Camera")).GetLocalTransformation()
    assert pose.TransformDir((0.0, 0.0, -1.0)) == pytest.approx((0.0, 0.0, 1.0))
    assert pose.TransformDir((0.0, 1.0, 0.0)) == pytest.approx((0.0, 1.0, 0.0))
    shape = UsdGeom.Capsule(usd.GetPrimAtPath(f"{tip}/Shape"))
    front = shape.GetHeightAttr().Get() / 2 + shape.GetRadiusAttr().Get()
    assert front - pose.ExtractTranslation()[2] == pytest.approx(0.001)


def joint(usd: Usd.Stage, name: str) -> Usd.Prim:
    return usd.GetPrimAtPath(f"/Endoscope/Joints/{name}")


def link(usd: Usd.Stage, name: str) -> Usd.Prim:
    return usd.GetPrimAtPath(f"/Endoscope/Links/{name}")


DEFECTS: dict[str, tuple[Callable[[Usd.Stage], object], list[str]]] = {
    "centimeters": (lambda usd: UsdGeom.SetStageMetersPerUnit(usd, 0.01), ["metersPerUnit", "0.01", "meters"]),
    "y_up": (lambda usd: UsdGeom.SetStageUpAxis(usd, "Y"), ["upAxis", "Z up"]),
    "no_articulation": (
        lambda usd: usd.GetDefaultPrim().ClearMetadata("apiSchemas"),
        ["/Endoscope", "ArticulationRootAPI", "Apply"],
    ),
    "no_rigid_body": (
        lambda usd: link(usd, "link_03").RemoveAPI(UsdPhysics.RigidBodyAPI),
        ["bend_x_03", "physics:body1", "link_03"],
    ),
    "no_collider": (
        lambda usd: usd.GetPrimAtPath("/Endoscope/Links/link_02/Shape").RemoveAPI(UsdPhysics.CollisionAPI),
        ["link_02/Shape", "CollisionAPI"],
    ),
    "massless": (lambda usd: link(usd, "link_01").GetAttribute("physics:mass").Set(0.0), ["link_01", "physics:mass"]),
    "missing_hinge": (lambda usd: usd.RemovePrim("/Endoscope/Joints/bend_y_02"), ["bend_y_02", "no such prim"]),
    "no_drive": (
        lambda usd: joint(usd, "bend_x_02").RemoveAPI(UsdPhysics.DriveAPI, "angular"),
        ["bend_x_02", "PhysicsDriveAPI:angular"],
    ),
    "wrong_axis": (
        lambda usd: joint(usd, "bend_y_02").GetAttribute("physics:axis").Set("X"),
        ["bend_y_02", "physics:axis", "'Y'"],
    ),
    "locked_slide": (
        lambda usd: joint(usd, "root").GetAttribute("limit:transZ:physics:low").Set(9.0),
        ["/root", "limit:transZ:physics:low", "low < high"],
    ),
    "shifted_hinge": (
        lambda usd: joint(usd, "bend_x_01").GetAttribute("physics:localPos0").Set((0.0, 0.0, 0.03)),
        ["bend_x_01", "physics:localPos0", f"{SHAFT_LINK:g}"],
    ),
    "degrees_of_view": (
        lambda usd: usd.GetPrimAtPath("/Endoscope/Links/link_05/Camera").GetAttribute("arcgym:fieldOfView").Set(150.0),
        ["Camera", "arcgym:fieldOfView", "radians"],
    ),
}


@pytest.mark.parametrize("defect", DEFECTS)
def test_broken_stage_is_named_with_its_mend(tmp_path: Path, defect: str) -> None:
    path = write_tiny_scope(tmp_path / "scope.usda")
    usd = Usd.Stage.Open(str(path))
    spoil, words = DEFECTS[defect]
    spoil(usd)
    usd.GetRootLayer().Save()
    with pytest.raises(StageError) as error:
        read_endoscope(path)
    assert all(word in str(error.value) for word in ["scope.usda", *words]), str(error.value)


def test_wrong_path_lists_what_is_there(tmp_path: Path) -> None:
    write_tiny_scope(tmp_path / "scope.usda")
    with pytest.raises(StageError, match=r"no such file.*scope\.usda"):
        read_endoscope(tmp_path / "scop.usda")


def test_text_file_is_no_stage(tmp_path: Path) -> None:
    (tmp_path / "scope.usda").write_text("hello")
    with pytest.raises(StageError, match="not a USD file"):
        read_endoscope(tmp_path / "scope.usda")


def test_assets_dir_names_the_places_tried(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert (assets_dir() / "endoscopes").is_dir()
    monkeypatch.setenv(ASSETS_ENV, str(tmp_path / "nowhere"))
    with pytest.raises(FileNotFoundError, match="nowhere"):
        assets_dir()
