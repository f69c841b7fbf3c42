# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A stage that cannot be used says where it is wrong and how to mend it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom
from tiny import tiny_colon_stage, write_tiny_colon

from arcgym.anatomy import StageError, read_colon, write_colon


def _broken(folder: Path, change: Callable[[Usd.Stage], None]) -> Path:
    """Write the tiny colon, changes its composed stage and write that out flat."""
    usd = Usd.Stage.Open(str(write_tiny_colon(folder)))
    change(usd)
    usd.Flatten().Export(str(folder / "broken.usda"))
    return folder / "broken.usda"


def set_first(usd: Usd.Stage, prim: str, attribute: str, value: float) -> None:
    """Replace the first number of an array."""
    found = usd.GetPrimAtPath(prim).GetAttribute(attribute)
    values = list(found.Get())
    found.Set([value, *values[1:]])


def name_texture_by_text(usd: Usd.Stage) -> None:
    """Make the attribute of the texture a plain text, which names no file."""
    mucosa = usd.GetPrimAtPath("/Colon/Mucosa")
    mucosa.RemoveProperty("arcgym:detailTexture")
    mucosa.CreateAttribute("arcgym:detailTexture", Sdf.ValueTypeNames.String).Set("detail.png")


def _remove(prim: str, attribute: str) -> Callable[[Usd.Stage], None]:
    return lambda usd: usd.GetPrimAtPath(prim).GetAttribute(attribute).Block()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda usd: UsdGeom.SetStageMetersPerUnit(usd, 0.01), "metersPerUnit.*found 0.01, expected 1"),
        (lambda usd: UsdGeom.SetStageUpAxis(usd, "Y"), "upAxis.*found Y, expected Z"),
        (lambda usd: usd.GetPrimAtPath("/Colon/Landmarks").SetActive(False), "prim /Colon/Landmarks.*missing"),
        (lambda usd: usd.GetPrimAtPath("/Colon/Wall").SetTypeName("Mesh"), "type is 'Mesh', expected 'TetMesh'"),
        (_remove("/Colon/Wall", "primvars:arcgym:anchor"), "prim /Colon/Wall, attribute 'primvars:arcgym:anchor'"),
        (_remove("/Colon/Visual", "primvars:arcgym:skinWeights"), "/Colon/Visual, .*skinWeights.*missing or empty"),
        (
            lambda usd: usd.GetPrimAtPath("/Colon/Wall").RemoveAppliedSchema("PhysicsVolumeDeformableSimAPI"),
            "PhysicsVolumeDeformableSimAPI not applied. Add prepend apiSchemas",
        ),
        (
            lambda usd: usd.GetPrimAtPath("/Colon/Wall").GetAttribute("primvars:arcgym:ring").Set([0, 1, 2]),
            "primvars:arcgym:ring.*3 numbers, expected 272 rows",
        ),
        (
            lambda usd: usd.GetPrimAtPath("/Colon/Tissue").GetAttribute("physics:poissonsRatio").Set(0.5),
            "/Colon/Tissue.*nu 0.5",
        ),
        (
            lambda usd: set_first(usd, "/Colon/Centerline", "primvars:arcgym:segment", 8),
            "/Colon/Centerline, .*segment': indices from [0-9] to 8, expected 0 to 7",
        ),
        (
            lambda usd: set_first(usd, "/Colon/Wall", "primvars:arcgym:segment", -1),
            "/Colon/Wall, .*segment': indices from -1 to [0-9], expected 0 to 7",
        ),
        (
            lambda usd: set_first(usd, "/Colon/Centerline", "primvars:arcgym:arc", 9.0),
            "/Colon/Centerline, .*arc': 1 of [0-9]+ steps do not ascend",
        ),
        (
            lambda usd: set_first(usd, "/Colon/Wall", "arcgym:ringArc", 9.0),
            "/Colon/Wall, attribute 'arcgym:ringArc': 1 of [0-9]+ steps do not ascend",
        ),
        (name_texture_by_text, "/Colon/Mucosa, attribute 'arcgym:detailTexture': a str, expected a texture"),
    ],
)
def test_broken_stage(tmp_path: Path, change: Callable[[Usd.Stage], None], message: str) -> None:
    with pytest.raises(StageError, match=message):
        read_colon(_broken(tmp_path, change))


def test_missing_file_lists_existing_stages(tiny_colon_path: Path) -> None:
    with pytest.raises(StageError, match=f"no such file. Existing stages in .*: .*{tiny_colon_path.name}"):
        read_colon(tiny_colon_path.parent / "colon_9" / "colon.usda")


def test_missing_file_far_from_any_stage_lists_those_that_ship(tmp_path: Path) -> None:
    with pytest.raises(StageError, match="no such file. Stages that come with ARCGym: colon_1, .*, ct_2"):
        read_colon(tmp_path / "a" / "b" / "colon.usda")


def test_not_a_usd_file(tmp_path: Path) -> None:
    (tmp_path / "colon.usda").write_text("hello")
    with pytest.raises(StageError, match=r"not a USD file \([^(]* is not a valid usda layer\). Pass"):
        read_colon(tmp_path / "colon.usda")


def test_the_line_of_a_file_that_is_cut_off_is_named(tmp_path: Path) -> None:
    (tmp_path / "colon.usda").write_text('#usda 1.0\ndef Xform "a" {\n    float x = \n')
    with pytest.raises(StageError, match=r"not a USD file \(.*colon.usda:3:[^\n]*\). Pass"):
        read_colon(tmp_path / "colon.usda")


def test_missing_texture(tmp_path: Path) -> None:
    path = write_tiny_colon(tmp_path)
    (tmp_path / "albedo.png").unlink()
    with pytest.raises(StageError, match="albedo.png does not exist"):
        read_colon(path)


def test_inverted_tetrahedron(tmp_path: Path) -> None:
    stage = tiny_colon_stage()
    stage.wall.tets[7] = stage.wall.tets[7][[1, 0, 2, 3]]
    with pytest.raises(StageError, match="1 of 786 tetrahedra are inverted.*number 7.*Swap two indices"):
        read_colon(write_colon(stage, tmp_path / "colon.usda"))


def test_outward_normals(tmp_path: Path) -> None:
    stage = tiny_colon_stage()
    visual = replace(stage.visual, normals=-stage.visual.normals)
    with pytest.raises(StageError, match="/Colon/Visual, attribute 'normals': 100 % .* away from the lumen"):
        read_colon(write_colon(replace(stage, visual=visual), tmp_path / "colon.usda"))


def test_outward_winding(tmp_path: Path) -> None:
    stage = tiny_colon_stage()
    visual = replace(stage.visual, faces=stage.visual.faces[:, ::-1])
    with pytest.raises(StageError, match="faceVertexIndices.*wound"):
        read_colon(write_colon(replace(stage, visual=visual), tmp_path / "colon.usda"))


def test_not_finite(tmp_path: Path) -> None:
    stage = tiny_colon_stage()
    stage.wall.points[5] = np.nan
    with pytest.raises(StageError, match="/Colon/Wall, attribute 'points': 3 numbers are not finite"):
        read_colon(write_colon(stage, tmp_path / "colon.usda"))
