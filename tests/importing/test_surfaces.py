# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces in every format, unit and winding are filled to the same lumen."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from arcgym.anatomy.importing.surfaces import read_surface

LENGTH, RADIUS = 0.40, 0.02
VOLUME = np.pi * RADIUS**2 * LENGTH


def write(path: Path, points: np.ndarray, faces: np.ndarray) -> Path:
    if path.suffix not in (".vtk", ".vtp"):
        trimesh.Trimesh(points, faces, process=False).export(path)
        return path
    vertices, cells, data = vtkPoints(), vtkCellArray(), vtkPolyData()
    vertices.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(faces.astype(np.int64).ravel(), deep=True))
    data.SetPoints(vertices)
    data.SetPolys(cells)
    writer = vtkXMLPolyDataWriter() if path.suffix == ".vtp" else vtkPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    writer.Write()
    return path


def cylinder(open_end: bool) -> tuple[np.ndarray, np.ndarray]:
    mesh = trimesh.creation.cylinder(RADIUS, LENGTH, sections=48)
    top = mesh.vertices[mesh.faces][:, :, 2].min(1) > 0.5 * LENGTH - 1e-6
    return np.asarray(mesh.vertices), np.asarray(mesh.faces[~top] if open_end else mesh.faces)


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".ply", ".vtk", ".vtp", ".glb"])
@pytest.mark.parametrize(("unit", "scale", "winding", "open_end"), [("mm", 1e3, -1, True), ("m", 1.0, 1, False)])
def test_lumen_has_its_volume(
    suffix: str, unit: str, scale: float, winding: int, open_end: bool, tmp_path: Path
) -> None:
    points, faces = cylinder(open_end)
    path = write(tmp_path / f"tube{suffix}", scale * points, faces[:, ::winding])
    grid, used = read_surface(path, "auto", None, 0.002)
    assert used == unit
    assert grid.mask.sum() * grid.spacing**3 == pytest.approx(VOLUME, rel=0.03)


def test_every_component_is_filled(tmp_path: Path) -> None:
    points, faces = cylinder(open_end=False)
    ball = trimesh.creation.icosphere(radius=0.03)
    both = np.concatenate([points, ball.vertices + [0.1, 0.0, 0.0]]), np.concatenate([faces, ball.faces + len(points)])
    grid, _ = read_surface(write(tmp_path / "two.ply", *both), "m", None, 0.002)
    assert grid.mask.sum() * grid.spacing**3 == pytest.approx(VOLUME + 4 / 3 * np.pi * 0.03**3, rel=0.03)
