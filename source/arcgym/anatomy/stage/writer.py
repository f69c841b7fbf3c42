# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Write a colon as a USD stage: a short text layer over a binary layer that holds the arrays."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdShade, Vt

from arcgym.anatomy.stage import layout
from arcgym.anatomy.stage.types import Centerline, ColonStage, ContactSurface, TissueMaterial, VisualMesh, WallMesh

_FRAME = "metres, Z up; +X patient's right, +Y anterior, +Z cranial (right-handed); anal verge at the origin"
"""Units and axes, for readers of the file."""


def write_colon(stage: ColonStage, path: str | Path) -> Path:
    """Write ``<path>`` (text), ``<path with .usdc>`` (arrays) and copy the textures beside them.

    Args:
        stage: The colon.
        path: File to write, ending in ``.usda``; its folder is made if need be.

    Returns:
        The path of the text layer.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    arrays_path = path.with_suffix(".usdc")
    textures = [_copy_beside(texture, path.parent) for texture in (stage.albedo_texture, stage.detail_texture)]
    _save_layer(arrays_path, lambda usd: _author_arrays(usd, stage))
    _save_layer(path, lambda usd: _author_head(usd, stage, *textures), sublayer=f"./{arrays_path.name}")
    return path


def _save_layer(path: Path, author: Callable[[Usd.Stage], None], sublayer: str = "") -> None:
    """Write a layer in one go: an interrupted run leaves no half-written file."""
    layer = Sdf.Layer.CreateAnonymous(path.suffix)
    usd = Usd.Stage.Open(layer)
    UsdGeom.SetStageUpAxis(usd, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(usd, 1.0)
    usd.SetDefaultPrim(UsdGeom.Xform.Define(usd, layout.ROOT_PATH).GetPrim())
    author(usd)
    del usd
    if sublayer:
        layer.subLayerPaths.append(sublayer)
    layer.Export(str(path))


def _copy_beside(texture: Path, folder: Path) -> str:
    target = folder / texture.name
    if texture.resolve() != target.resolve():
        shutil.copyfile(texture, target)
    return f"./{texture.name}"


def _author_arrays(usd: Usd.Stage, stage: ColonStage) -> None:
    _author_wall(usd, stage.wall)
    _author_visual(usd, layout.VISUAL_PATH, stage.visual, UsdGeom.Tokens.render)
    _author_visual(usd, layout.PROXY_PATH, stage.visual_proxy, UsdGeom.Tokens.proxy)
    if stage.contact is not None:
        _author_contact(usd, stage.contact)
    _author_centerline(usd, stage.centerline)


def _author_head(usd: Usd.Stage, stage: ColonStage, albedo: str, detail: str) -> None:
    root = usd.GetDefaultPrim()
    Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
    metadata = {"name": stage.name, "frame": _FRAME, **stage.metadata}
    root.SetCustomDataByKey(layout.CUSTOM_DATA, metadata)
    _author_tissue(usd, stage.material)
    _author_mucosa(usd, albedo, detail)
    _author_landmarks(usd, stage)


def _primvar(prim: Usd.Prim, name: str, values: np.ndarray) -> None:
    """Write a per-vertex primvar; rows of four become one flat array with elementSize 4."""
    width = values.shape[1] if values.ndim == 2 else 1
    if values.dtype.kind == "i":
        type_name, array = Sdf.ValueTypeNames.IntArray, Vt.IntArray.FromNumpy(values.astype(np.int32).ravel())
    else:
        type_name, array = Sdf.ValueTypeNames.FloatArray, Vt.FloatArray.FromNumpy(values.astype(np.float32).ravel())
    UsdGeom.PrimvarsAPI(prim).CreatePrimvar(name, type_name, UsdGeom.Tokens.vertex, width).Set(array)


def _points(geometry: UsdGeom.PointBased, points: np.ndarray) -> None:
    points = np.ascontiguousarray(points, np.float32)
    geometry.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    geometry.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([points.min(0), points.max(0)])))


def _author_wall(usd: Usd.Stage, wall: WallMesh) -> None:
    mesh = UsdGeom.TetMesh.Define(usd, layout.WALL_PATH)
    prim = mesh.GetPrim()
    _points(mesh, wall.points)
    mesh.CreateTetVertexIndicesAttr(Vt.Vec4iArray.FromNumpy(np.ascontiguousarray(wall.tets, np.int32)))
    mesh.CreateSurfaceFaceVertexIndicesAttr(UsdGeom.TetMesh.ComputeSurfaceFaces(mesh))
    mesh.CreateOrientationAttr(UsdGeom.Tokens.rightHanded)
    mesh.CreatePurposeAttr(UsdGeom.Tokens.guide)
    for schema in layout.WALL_SCHEMAS:
        prim.AddAppliedSchema(schema)
    for name, values in (
        (layout.ANCHOR, wall.anchor),
        (layout.SEGMENT, wall.segment),
        (layout.RING, wall.ring),
        (layout.LAYER, wall.layer),
        (layout.FRAME_NEIGHBORS, wall.frame_neighbors),
    ):
        _primvar(prim, name, values)
    ring_arc = prim.CreateAttribute(layout.RING_ARC, Sdf.ValueTypeNames.FloatArray)
    ring_arc.Set(Vt.FloatArray.FromNumpy(np.ascontiguousarray(wall.ring_arc, np.float32)))


def _author_visual(usd: Usd.Stage, path: str, visual: VisualMesh, purpose: str) -> None:
    mesh = UsdGeom.Mesh.Define(usd, path)
    prim = mesh.GetPrim()
    _points(mesh, visual.points)
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray(len(visual.faces), 3))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(visual.faces, np.int32).ravel()))
    mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(visual.normals, np.float32)))
    mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreateDoubleSidedAttr(True)
    mesh.CreatePurposeAttr(purpose)
    texcoord = Sdf.ValueTypeNames.TexCoord2fArray
    uv = UsdGeom.PrimvarsAPI(prim).CreatePrimvar(layout.UV, texcoord, UsdGeom.Tokens.vertex)
    uv.Set(Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(visual.uv, np.float32)))
    _primvar(prim, layout.TINT, visual.tint)
    _primvar(prim, layout.SKIN_INDICES, visual.skin_indices)
    _primvar(prim, layout.SKIN_WEIGHTS, visual.skin_weights)


def _author_contact(usd: Usd.Stage, contact: ContactSurface) -> None:
    mesh = UsdGeom.Mesh.Define(usd, layout.CONTACT_PATH)
    faces = contact.faces()
    _points(mesh, contact.points)
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray(len(faces), 3))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(faces.ravel()))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreatePurposeAttr(UsdGeom.Tokens.guide)
    mesh.GetPrim().CreateAttribute(layout.COLUMNS, Sdf.ValueTypeNames.Int).Set(contact.columns)
    _primvar(mesh.GetPrim(), layout.SKIN_INDICES, contact.skin_indices)
    _primvar(mesh.GetPrim(), layout.SKIN_WEIGHTS, contact.skin_weights)


def _author_centerline(usd: Usd.Stage, centerline: Centerline) -> None:
    curve = UsdGeom.BasisCurves.Define(usd, layout.CENTERLINE_PATH)
    _points(curve, centerline.points)
    curve.CreateTypeAttr(UsdGeom.Tokens.linear)
    curve.CreateCurveVertexCountsAttr(Vt.IntArray([len(centerline.points)]))
    curve.CreateWidthsAttr(Vt.FloatArray([0.002]))
    curve.SetWidthsInterpolation(UsdGeom.Tokens.constant)
    curve.CreatePurposeAttr(UsdGeom.Tokens.guide)
    _primvar(curve.GetPrim(), layout.ARC, centerline.arc)
    _primvar(curve.GetPrim(), layout.RADIUS, centerline.radius)
    _primvar(curve.GetPrim(), layout.SEGMENT, centerline.segment)


def _author_tissue(usd: Usd.Stage, tissue: TissueMaterial) -> None:
    material = UsdShade.Material.Define(usd, layout.TISSUE_PATH)
    for schema in layout.MATERIAL_SCHEMAS:
        material.GetPrim().AddAppliedSchema(schema)
    for name, value in (
        ("physics:youngsModulus", tissue.youngs_modulus),
        ("physics:poissonsRatio", tissue.poissons_ratio),
        ("physics:density", tissue.density),
    ):
        material.GetPrim().CreateAttribute(name, Sdf.ValueTypeNames.Float).Set(value)
    wall = usd.OverridePrim(layout.WALL_PATH)
    UsdShade.MaterialBindingAPI.Apply(wall).Bind(material, materialPurpose="physics")


def _author_mucosa(usd: Usd.Stage, albedo: str, detail: str) -> None:
    """Write the look of the mucosa for USD viewers; ARCGym's camera reads the two textures itself."""
    material = UsdShade.Material.Define(usd, layout.MUCOSA_PATH)
    surface = _shader(usd, "Surface", "UsdPreviewSurface")
    texture = _shader(usd, "Albedo", "UsdUVTexture")
    reader = _shader(usd, "TexCoord", "UsdPrimvarReader_float2")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
    texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(Sdf.AssetPath(albedo))
    texture.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set("sRGB")
    for axis in ("wrapS", "wrapT"):
        texture.CreateInput(axis, Sdf.ValueTypeNames.Token).Set("repeat")
    coordinates = reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)
    texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(coordinates)
    color = texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3)
    surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).ConnectToSource(color)
    surface.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(0.25)
    material.CreateSurfaceOutput().ConnectToSource(surface.CreateOutput("surface", Sdf.ValueTypeNames.Token))
    asset = material.GetPrim().CreateAttribute(layout.DETAIL_TEXTURE, Sdf.ValueTypeNames.Asset)
    asset.Set(Sdf.AssetPath(detail))
    for path in (layout.VISUAL_PATH, layout.PROXY_PATH):
        UsdShade.MaterialBindingAPI.Apply(usd.OverridePrim(path)).Bind(material)


def _shader(usd: Usd.Stage, name: str, identifier: str) -> UsdShade.Shader:
    shader = UsdShade.Shader.Define(usd, f"{layout.MUCOSA_PATH}/{name}")
    shader.CreateIdAttr(identifier)
    return shader


def _author_landmarks(usd: Usd.Stage, stage: ColonStage) -> None:
    UsdGeom.Scope.Define(usd, layout.LANDMARKS_PATH)
    for name, arc in sorted(stage.landmarks.items(), key=lambda item: item[1]):
        point = [float(np.interp(arc, stage.centerline.arc, stage.centerline.points[:, k])) for k in range(3)]
        xform = UsdGeom.Xform.Define(usd, f"{layout.LANDMARKS_PATH}/{name}")
        xform.AddTranslateOp().Set(Gf.Vec3d(*(round(value, 6) for value in point)))
        xform.GetPrim().CreateAttribute(layout.LANDMARK_ARC, Sdf.ValueTypeNames.Double).Set(round(float(arc), 6))
