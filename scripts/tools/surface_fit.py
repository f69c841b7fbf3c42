# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measure how well the surfaces of the shipped colons follow the lumens that they were made of, and print a table.

A generated lumen is made again from its patient's spec. That of a colon from CT is the scanned surface, which is given
with the scan's own centerline [mm], for the canal that is drawn anew has another course than the scan's; or, with
--widened, the lumen that the importer made of it: canal drawn, narrow places widened, walls put between loops.

python scripts/tools/surface_fit.py colon_1 colon_2 colon_3 colon_4 colon_5
python scripts/tools/surface_fit.py ct_1=EdinGCA_3D_00020_large_intestine_mm.ply,EdinGCA_3D_00020_centerline_mm.csv
python scripts/tools/surface_fit.py --widened ct_1=EdinGCA_3D_00020_large_intestine_mm.ply
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy import read_colon
from arcgym.anatomy.polyline import arc_lengths
from arcgym.anatomy.stage.types import ColonStage
from arcgym.anatomy.validation.surface_distance import distance_to_surface, surface_samples
from arcgym.utils.paths import assets_dir

SAMPLES = 100_000
"""Samples of each surface."""
CANAL = 0.02
"""Arc length along the stage's centerline from which it is measured [m]."""
SCANNED_CANAL = 0.10
"""The same of a scan, along the scan's own centerline, and of the stage that is compared with it [m]."""

Surface = tuple[np.ndarray, np.ndarray]
"""Vertices [m], shape (n, 3), and triangles, shape (F, 3)."""
Way = tuple[np.ndarray, np.ndarray]
"""Points of a centerline [m], shape (n, 3), and their arc lengths from the anus [m], shape (n,)."""


def generated_lumen(name: str, stage: ColonStage) -> Surface:
    """Return the surface of a patient's lumen, made again from the spec."""
    from arcgym.anatomy.generator.fitting import LEG_GAP
    from arcgym.anatomy.generator.generate import draw_surface
    from arcgym.anatomy.generator.lumen_field import LumenField
    from arcgym.anatomy.generator.patients import PATIENTS
    from arcgym.anatomy.meshing.triangle_surface import cut_surface

    spec = PATIENTS[name]()
    surface, _ = draw_surface(spec, int(stage.metadata["attempt"]))
    grid = LumenField(surface, 2 * spec.wall_thickness + LEG_GAP).sample()
    lumen = cut_surface(grid.values, grid.origin, grid.spacing)
    return lumen.points, lumen.faces


def placed(points: np.ndarray, stage: ColonStage) -> np.ndarray:
    """Return points of a scan [m] in the stage's frame, shape (n, 3)."""
    turn = np.reshape(stage.metadata["rotationFromSource"], (3, 3))
    return points @ turn.T + np.asarray(stage.metadata["translationAfterRotation"])


def scanned_lumen(path: Path, stage: ColonStage) -> Surface:
    """Return the surface that a stage was imported from, moved into the stage's frame."""
    from arcgym.anatomy.importing.surfaces import load_surface

    points, faces, _ = load_surface(path, "auto", None)
    return placed(points, stage), faces


def scanned_way(path: Path, stage: ColonStage) -> Way:
    """Return a scan's own centerline, a table of x, y, z [mm] with a line of headings, in the stage's frame."""
    points = placed(1e-3 * np.loadtxt(path, delimiter=",", skiprows=1), stage)
    ends = np.linalg.norm(points[[0, -1]] - stage.centerline.points[0], axis=1)
    points = points if ends[0] < ends[1] else points[::-1]
    return points, arc_lengths(points)


def widened_lumen(path: Path) -> Surface:
    """Return the surface of the lumen that the importer makes of a scan with its defaults, in the stage's frame."""
    from arcgym.anatomy.importing.lumen import Progress, find_lumen
    from arcgym.anatomy.importing.settings import ImportSettings
    from arcgym.anatomy.meshing.voxel_surface import voxel_surface

    lumen = find_lumen(path, ImportSettings(), Progress())
    verge = lumen.line[0]
    found = voxel_surface(lumen.grid.values, lumen.grid.origin - verge, lumen.grid.spacing, lumen.line - verge)
    return found.surface.points, found.surface.faces


def figures(stage: ColonStage, lumen: Surface, way: Way | None) -> list[float]:
    """Return the 95th percentiles of distances [mm]: lumen to contact, to visual, to proxy, and each one's back.

    Args:
        stage: The stage.
        lumen: What it was made of.
        way: Centerline of a scan by which its beginning is left out; None takes the stage's.
    """
    own = stage.centerline.points, stage.centerline.arc
    first = CANAL if way is None else SCANNED_CANAL

    def beyond(surface: Surface, line: Way) -> np.ndarray:
        samples = surface_samples(*surface, SAMPLES)
        return samples[line[1][cKDTree(line[0]).query(samples)[1]] > first]

    contact = stage.contact.points, stage.contact.faces()
    visual, proxy = ((mesh.points, mesh.faces[(mesh.tint[mesh.faces] == 0.0).all(1)]) for mesh in _meshes(stage))
    there = [distance_to_surface(beyond(lumen, way or own), *surface) for surface in (contact, visual, proxy)]
    back = [distance_to_surface(beyond(surface, own), *lumen) for surface in (contact, visual, proxy)]
    return [1e3 * float(np.percentile(values, 95)) for values in (*there, *back)]


def _meshes(stage: ColonStage) -> tuple:
    return stage.visual, stage.visual_proxy


def main() -> None:
    """Measure the colons that are named."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("colons", nargs="+", help="names of generated patients, or NAME=FILE[,CENTERLINE] of CT")
    parser.add_argument(
        "--widened", action="store_true", help="compare colons from CT with what the importer made of them"
    )
    args = parser.parse_args()
    print("| 95th percentile [mm] | lumen to contact | to visual | to proxy | contact to lumen | visual | proxy |")
    print("|---|---|---|---|---|---|---|")
    for entry in args.colons:
        name, _, files = entry.partition("=")
        file, _, line = files.partition(",")
        if file and not (line or args.widened):
            parser.error(f"{entry} names no centerline of the scan: give {name}={file},CENTERLINE, or --widened")
        stage = read_colon(assets_dir() / name / "colon.usda")
        if not file:
            lumen = generated_lumen(name, stage)
        else:
            lumen = widened_lumen(Path(file)) if args.widened else scanned_lumen(Path(file), stage)
        way = scanned_way(Path(line), stage) if line and not args.widened else None
        print("|", name, "|", " | ".join(f"{value:.2f}" for value in figures(stage, lumen, way)), "|", flush=True)


if __name__ == "__main__":
    main()
