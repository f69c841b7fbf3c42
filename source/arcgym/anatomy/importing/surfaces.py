# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Read triangle surfaces, in millimeters or meters, and fill them on a grid."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.formats import UNITS
from arcgym.anatomy.importing.size_limits import check_voxels
from arcgym.anatomy.voxel_grid import Grid

_COLON_EXTENT = (0.20, 0.70)
"""Least and largest extent of a colon [m], by which the unit is chosen."""

_LARGEST_HOLE = 0.08
"""Radius of the largest hole that is closed [m]."""

_MARGIN = 0.006
"""Room that is left round the lumen [m]."""


def read_surface(path: Path, units: str, scale: tuple[float, ...] | None, voxel: float) -> tuple[Grid, str]:
    """Read a surface and fill it.

    Args:
        path: File with one of :data:`arcgym.anatomy.importing.formats.SURFACE_SUFFIXES`.
        units: A key of :data:`arcgym.anatomy.importing.formats.UNITS`, or ``auto`` to tell by the size.
        scale: Factors along the file's axes, for surfaces in voxels; applied first.
        voxel: Edge of the voxels of the result [m].

    Returns:
        The filled surface with the file's axes, and the unit that was used.

    Raises:
        ColonImportError: The file is damaged, empty, not finite, or of no colon's size.
    """
    points, faces, unit = load_surface(path, units, scale)
    return fill_surface(points, faces, voxel), unit


def load_surface(path: Path, units: str, scale: tuple[float, ...] | None) -> tuple[np.ndarray, np.ndarray, str]:
    """Read a surface: vertices [m], triangles and the unit that was used; arguments as for :func:`read_surface`."""
    points, faces = _load_vtk(path) if path.suffix.lower() in (".vtk", ".vtp") else _load_mesh(path)
    if len(faces) < 100:
        raise ColonImportError(f"{path} holds {len(faces)} triangles", "Pass a closed surface of the colon's lumen.")
    if not np.isfinite(points).all():
        bad = int((~np.isfinite(points)).any(1).sum())
        raise ColonImportError(f"{path} holds {bad} vertices that are NaN or infinite", "Repair the surface first.")
    points = points * (1.0 if scale is None else np.asarray(scale, float))
    unit = _guess_unit(path, points) if units == "auto" else units
    return points * UNITS[unit], faces, unit


def _load_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    import trimesh

    try:
        mesh = trimesh.load(path, force="mesh", process=False)
        return np.asarray(mesh.vertices, float), np.asarray(mesh.faces, int)
    except Exception as error:  # readers of seven formats raise what they like on damaged files
        raise ColonImportError(f"{path} cannot be read: {error}", "Check that the file is complete.") from error


def _load_vtk(path: Path) -> tuple[np.ndarray, np.ndarray]:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter
    from vtkmodules.vtkIOLegacy import vtkPolyDataReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reader = vtkXMLPolyDataReader() if path.suffix.lower() == ".vtp" else vtkPolyDataReader()
    reader.SetFileName(str(path))
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(reader.GetOutputPort())
    triangles.PassLinesOff()
    triangles.PassVertsOff()
    triangles.Update()
    data = triangles.GetOutput()
    if reader.GetErrorCode() or not data.GetNumberOfPolys():
        raise ColonImportError(f"{path} holds no triangles that VTK can read", "Pass a complete PolyData file.")
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    return points, vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3).astype(int)


def _guess_unit(path: Path, points: np.ndarray) -> str:
    extent = float(np.ptp(points, axis=0).max())
    low, high = _COLON_EXTENT
    for unit, meters in UNITS.items():
        if low <= extent * meters <= high:
            return unit
    raise ColonImportError(
        f"{path} is {extent:.4g} units long, which is no colon's size in mm, cm or m ({low:g} to {high:g} m)",
        "Pass --units, or --spacing X Y Z if the surface is in voxels.",
    )


def fill_surface(points: np.ndarray, faces: np.ndarray, voxel: float) -> Grid:
    """Return the inside of a surface: vertices [m], triangles, edge of the voxels [m]."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkImagingStencil import vtkImageStencilToImage, vtkPolyDataToImageStencil

    origin = points.min(0) - _MARGIN
    check_voxels(np.ptp(points, axis=0) + 2 * _MARGIN, voxel)
    size = np.ceil((points.max(0) + _MARGIN - origin) / voxel).astype(int) + 1
    frame = vtkImageData()
    frame.SetDimensions(*size.tolist())
    stencil = vtkPolyDataToImageStencil()
    stencil.SetInputData(_closed(points, faces))
    stencil.SetOutputOrigin(*origin.tolist())
    stencil.SetOutputSpacing(voxel, voxel, voxel)
    stencil.SetOutputWholeExtent(frame.GetExtent())
    image = vtkImageStencilToImage()
    image.SetInputConnection(stencil.GetOutputPort())
    image.SetInsideValue(1)
    image.SetOutsideValue(0)
    image.SetOutputScalarTypeToUnsignedChar()
    image.Update()
    flat = vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())
    values = flat.reshape(size[::-1]).transpose(2, 1, 0).astype(np.float32)
    return Grid(np.ascontiguousarray(values), origin, voxel)


def _closed(points: np.ndarray, faces: np.ndarray) -> Any:
    """Return the surface as VTK polygons, vertices merged and holes up to an open rectum's size closed."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkCleanPolyData
    from vtkmodules.vtkFiltersModeling import vtkFillHolesFilter

    vertices, cells, data = vtkPoints(), vtkCellArray(), vtkPolyData()
    vertices.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(faces.astype(np.int64).ravel(), deep=True))
    data.SetPoints(vertices)
    data.SetPolys(cells)
    clean, fill = vtkCleanPolyData(), vtkFillHolesFilter()
    clean.SetInputData(data)
    fill.SetInputConnection(clean.GetOutputPort())
    fill.SetHoleSize(_LARGEST_HOLE)
    fill.Update()
    return fill.GetOutput()
