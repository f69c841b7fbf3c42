# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Read a colon stage and say precisely what is wrong with it when it cannot be used."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdShade

from arcgym.anatomy.measures import flipped_normal_fraction, tet_volumes, winds_outwards
from arcgym.anatomy.segments import SEGMENTS
from arcgym.anatomy.stage import layout
from arcgym.anatomy.stage.opening import open_stage
from arcgym.anatomy.stage.types import (
    Centerline,
    ColonStage,
    ContactSurface,
    StageError,
    TissueMaterial,
    VisualMesh,
    WallMesh,
)
from arcgym.utils.paths import assets_dir

_REMAKE = "Remake the stage with scripts/tools/author_assets.py or write it with arcgym.anatomy.write_colon"
"""Advice where a stage is broken."""


def read_colon(path: str | Path) -> ColonStage:
    """Read and check a colon stage.

    Args:
        path: The stage, usually ``assets/usd/colon_<n>/colon.usda``.

    Raises:
        StageError: The stage is missing or unusable; the message says where, what was found and how to mend it.
    """
    path = Path(path)
    reader = _Reader(path)
    root = reader.prim(layout.ROOT_PATH)
    metadata = dict(root.GetCustomDataByKey(layout.CUSTOM_DATA) or {})
    centerline = _read_centerline(reader)
    wall = _read_wall(reader)
    return ColonStage(
        name=str(metadata.get("name", path.parent.name)),
        wall=wall,
        visual=_read_visual(reader, layout.VISUAL_PATH, len(wall.points)),
        visual_proxy=_read_visual(reader, layout.PROXY_PATH, len(wall.points)),
        centerline=centerline,
        landmarks=_read_landmarks(reader),
        material=_read_tissue(reader),
        albedo_texture=reader.asset(f"{layout.MUCOSA_PATH}/Albedo", "inputs:file"),
        detail_texture=reader.asset(layout.MUCOSA_PATH, layout.DETAIL_TEXTURE),
        metadata=metadata,
        contact=_read_contact(reader, len(wall.points)),
    )


class _Reader:
    """An open stage plus the errors of everything that can be missing in it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.usd = open_stage(
            path,
            missing=lambda: _list_stages(path),
            meters="Scale the points to meters and set metersPerUnit = 1",
            up='Turn the points so that +Z is cranial and set upAxis = "Z"',
        )

    def error(self, prim: str, attribute: str, found: str, mend: str = _REMAKE) -> StageError:
        return StageError(self.path, prim, attribute, found, mend)

    def prim(self, path: str, type_name: str = "") -> Usd.Prim:
        prim = self.usd.GetPrimAtPath(path)
        if not prim or not prim.IsDefined() or not prim.IsActive():
            have = ", ".join(str(child.GetPath()) for child in self.usd.Traverse()) or "nothing"
            raise self.error(path, "", f"the prim is missing; the stage has {have[:300]}")
        if type_name and prim.GetTypeName() != type_name:
            raise self.error(path, "", f"type is '{prim.GetTypeName()}', expected '{type_name}'")
        return prim

    def value(self, path: str, name: str) -> Any:
        value = self.prim(path).GetAttribute(name).Get() if self.prim(path).HasAttribute(name) else None
        if value is None:
            raise self.error(path, name, "the attribute is missing or empty")
        return value

    def array(self, path: str, name: str, width: int = 1, rows: int | None = None) -> np.ndarray:
        """Read an array as (rows, width), or (rows,) for width 1, and check its length and that it is finite."""
        value = np.asarray(self.value(path, name))
        kind = np.int32 if value.dtype.kind in "iu" else np.float32
        if value.size % width or (rows is not None and value.size != rows * width):
            wanted = f"{rows} rows of {width}" if rows is not None else f"a multiple of {width}"
            raise self.error(path, name, f"{value.size} numbers, expected {wanted}")
        if not np.isfinite(value).all():
            raise self.error(path, name, f"{int((~np.isfinite(value)).sum())} numbers are not finite")
        value = np.array(value, kind)
        return value.reshape(-1, width) if width > 1 else value.reshape(-1)

    def indices(self, path: str, name: str, width: int, count: int, rows: int | None = None) -> np.ndarray:
        """Read an index array and check that every index points at one of ``count`` things."""
        value = self.array(path, name, width, rows)
        if value.size and (value.min() < 0 or value.max() >= count):
            raise self.error(path, name, f"indices from {value.min()} to {value.max()}, expected 0 to {count - 1}")
        return value

    def arcs(self, path: str, name: str, rows: int | None = None) -> np.ndarray:
        """Read arc lengths and check that they ascend."""
        value = self.array(path, name, rows=rows)
        steps = np.diff(value)
        if not len(steps) or (steps <= 0).any():
            found = f"{int((steps <= 0).sum())} of {len(steps)} steps do not ascend"
            raise self.error(path, name, found, "Write two arc lengths or more, from the anal verge on")
        return value

    def asset(self, path: str, name: str) -> Path:
        asset = self.value(path, name)
        if not isinstance(asset, Sdf.AssetPath):
            mend = "Give the attribute the type 'asset'"
            raise self.error(path, name, f"a {type(asset).__name__}, expected a texture", mend)
        found = Path(asset.resolvedPath or self.path.parent / asset.path)
        if not found.is_file():
            mend = "Put the image there, or its path into the attribute; shipped colons share that of colon_1"
            raise self.error(path, name, f"texture {found} does not exist", mend)
        return found


def _list_stages(path: Path) -> str:
    """List the stages closest above the missing file, else those that come with ARCGym."""
    elsewhere = f"; nor is it in the working folder, {Path.cwd()}" if path.is_relative_to(assets_dir()) else ""
    for folder in list(path.parents)[:2]:
        stages = sorted([*folder.glob("colon.usda"), *folder.glob("*/colon.usda")])[:10]
        if stages:
            names = ", ".join(str(stage.relative_to(folder)) for stage in stages)
            return f"Existing stages in {folder}: {names}{elsewhere}"
    shipped = sorted(stage.parent.name for stage in assets_dir().glob("*/colon.usda"))
    return f"Stages that come with ARCGym: {', '.join(shipped)}{elsewhere}"


def _read_wall(reader: _Reader) -> WallMesh:
    path = layout.WALL_PATH
    _check_schemas(reader, reader.prim(path, "TetMesh"), layout.WALL_SCHEMAS)
    points = reader.array(path, "points", 3)
    count = len(points)
    ring_arc = reader.arcs(path, layout.RING_ARC)
    wall = WallMesh(
        points=points,
        tets=reader.indices(path, "tetVertexIndices", 4, count),
        anchor=reader.array(path, layout.ANCHOR, rows=count),
        segment=reader.indices(path, layout.SEGMENT, 1, len(SEGMENTS), count),
        ring=reader.indices(path, layout.RING, 1, len(ring_arc), count),
        layer=reader.array(path, layout.LAYER, rows=count),
        frame_neighbors=reader.indices(path, layout.FRAME_NEIGHBORS, 4, count, count),
        ring_arc=ring_arc,
    )
    volumes = tet_volumes(wall.points, wall.tets)
    if (volumes <= 0).any():
        bad = np.flatnonzero(volumes <= 0)
        found = f"{len(bad)} of {len(volumes)} tetrahedra are inverted or flat (the first is number {bad[0]})"
        mend = "Swap two indices of each inverted tetrahedron; its volume (b-a) x (c-a) . (d-a) / 6 must be positive"
        raise reader.error(path, "tetVertexIndices", found, mend)
    return wall


def _check_schemas(reader: _Reader, prim: Usd.Prim, schemas: tuple[str, ...]) -> None:
    applied = prim.GetAppliedSchemas() + list(prim.GetPrimTypeInfo().GetAppliedAPISchemas())
    missing = [schema for schema in schemas if schema not in applied]
    if missing:
        mend = f'Add prepend apiSchemas = ["{missing[0]}"] to the prim'
        raise reader.error(str(prim.GetPath()), "apiSchemas", f"{', '.join(missing)} not applied", mend)


def _read_visual(reader: _Reader, path: str, wall_count: int) -> VisualMesh:
    reader.prim(path, "Mesh")
    points = reader.array(path, "points", 3)
    count = len(points)
    visual = VisualMesh(
        points=points,
        faces=reader.indices(path, "faceVertexIndices", 3, count),
        normals=reader.array(path, "normals", 3, count),
        uv=reader.array(path, layout.UV, 2, count),
        tint=reader.array(path, layout.TINT, rows=count),
        skin_indices=reader.indices(path, layout.SKIN_INDICES, 4, wall_count, count),
        skin_weights=reader.array(path, layout.SKIN_WEIGHTS, 4, count),
    )
    _check_weights(reader, path, visual.skin_weights)
    if winds_outwards(visual.points, visual.faces):
        found = "the faces are wound so that they face away from the lumen"
        raise reader.error(path, "faceVertexIndices", found, "Reverse the order of each face's vertices")
    flipped = flipped_normal_fraction(visual)
    if flipped > 0.05:
        found = f"{100 * flipped:.0f} % of the normals point away from the lumen"
        raise reader.error(path, "normals", found, "Multiply them by -1: the visual normals point into the lumen")
    return visual


def _read_contact(reader: _Reader, wall_count: int) -> ContactSurface | None:
    """Read the contact surface; stages without one are touched at the wall's inner layer."""
    path = layout.CONTACT_PATH
    if not reader.usd.GetPrimAtPath(path):
        return None
    reader.prim(path, "Mesh")
    points, columns = reader.array(path, "points", 3), int(reader.value(path, layout.COLUMNS))
    if columns < 3 or len(points) % columns:
        mend = "Write rows of as many points as there are columns, three or more"
        raise reader.error(path, layout.COLUMNS, f"{len(points)} points in {columns} columns", mend)
    contact = ContactSurface(
        points=points,
        columns=columns,
        skin_indices=reader.indices(path, layout.SKIN_INDICES, 4, wall_count, len(points)),
        skin_weights=reader.array(path, layout.SKIN_WEIGHTS, 4, len(points)),
    )
    _check_weights(reader, path, contact.skin_weights)
    return contact


def _check_weights(reader: _Reader, path: str, weights: np.ndarray) -> None:
    sums = weights.sum(1)
    if np.abs(sums - 1).max() > 1e-3:
        found = f"weights of a vertex sum to {sums.min():.3f} to {sums.max():.3f}, expected 1"
        raise reader.error(path, layout.SKIN_WEIGHTS, found, "Divide each row by its sum")


def _read_centerline(reader: _Reader) -> Centerline:
    path = layout.CENTERLINE_PATH
    reader.prim(path, "BasisCurves")
    points = reader.array(path, "points", 3)
    count = len(points)
    return Centerline(
        points=points,
        arc=reader.arcs(path, layout.ARC, count),
        radius=reader.array(path, layout.RADIUS, rows=count),
        segment=reader.indices(path, layout.SEGMENT, 1, len(SEGMENTS), count),
    )


def _read_landmarks(reader: _Reader) -> dict[str, float]:
    children = reader.prim(layout.LANDMARKS_PATH).GetChildren()
    arcs = {child.GetName(): float(reader.value(str(child.GetPath()), layout.LANDMARK_ARC)) for child in children}
    return dict(sorted(arcs.items(), key=lambda item: item[1]))


def _read_tissue(reader: _Reader) -> TissueMaterial:
    wall = reader.prim(layout.WALL_PATH)
    material = UsdShade.MaterialBindingAPI(wall).ComputeBoundMaterial("physics")[0]
    if not material:
        mend = f"Bind {layout.TISSUE_PATH} to the wall with the purpose 'physics'"
        raise reader.error(layout.WALL_PATH, "material:binding:physics", "no physics material is bound", mend)
    path = str(material.GetPath())
    _check_schemas(reader, material.GetPrim(), layout.MATERIAL_SCHEMAS)
    names = ("youngsModulus", "poissonsRatio", "density")
    values = [round(float(reader.value(path, f"physics:{name}")), 6) for name in names]
    if not (values[0] > 0 and 0 <= values[1] < 0.5 and values[2] > 0):
        found = f"E {values[0]:g} Pa, nu {values[1]:g}, density {values[2]:g} kg/m^3"
        raise reader.error(path, "physics:*", found, "Use E > 0, 0 <= nu < 0.5 and density > 0 in SI units")
    return TissueMaterial(*values)
