# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measure how well the surfaces of the shipped colons follow the lumens that they were made of, and print a table.

A generated lumen is made again from its patient's spec; that of a colon from CT is the scanned surface, which is given:

python scripts/tools/surface_fit.py colon_1 colon_2 colon_3 colon_4 colon_5
python scripts/tools/surface_fit.py ct_1=EdinGCA_3D_00020_large_intestine_mm.ply
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from arcgym.anatomy import read_colon
from arcgym.anatomy.stage.types import ColonStage
from arcgym.anatomy.validation.surface_distance import distance_to_surface, surface_samples
from arcgym.utils.paths import assets_dir

SAMPLES = 100_000
"""Samples of each surface."""
CANAL = 0.02, 0.10
"""Arc length from which it is measured, of a generated colon and of one from CT, whose canal is drawn anew [m]."""

Surface = tuple[np.ndarray, np.ndarray]
"""Vertices [m], shape (n, 3), and triangles, shape (F, 3)."""


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


def scanned_lumen(path: Path, stage: ColonStage) -> Surface:
    """Return the surface that a stage was imported from, moved into the stage's frame."""
    from arcgym.anatomy.importing.surfaces import load_surface

    points, faces, _ = load_surface(path, "auto", None)
    turn = np.reshape(stage.metadata["rotationFromSource"], (3, 3))
    return points @ turn.T + np.asarray(stage.metadata["translationAfterRotation"]), faces


def figures(stage: ColonStage, lumen: Surface, first: float) -> list[float]:
    """Return the 95th percentiles of distances [mm]: lumen to contact, to visual, to proxy, and each one's back."""
    line = cKDTree(stage.centerline.points)

    def beyond(surface: Surface) -> np.ndarray:
        samples = surface_samples(*surface, SAMPLES)
        return samples[stage.centerline.arc[line.query(samples)[1]] > first]

    contact = stage.contact.points, stage.contact.faces()
    visual, proxy = ((mesh.points, mesh.faces[(mesh.tint[mesh.faces] == 0.0).all(1)]) for mesh in _meshes(stage))
    there = [distance_to_surface(beyond(lumen), *surface) for surface in (contact, visual, proxy)]
    back = [distance_to_surface(beyond(surface), *lumen) for surface in (contact, visual, proxy)]
    return [1e3 * float(np.percentile(values, 95)) for values in (*there, *back)]


def _meshes(stage: ColonStage) -> tuple:
    return stage.visual, stage.visual_proxy


def main() -> None:
    """Measure the colons that are named."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("colons", nargs="+", help="names of generated patients, or NAME=FILE of colons from CT")
    print("| 95th percentile [mm] | lumen to contact | to visual | to proxy | contact to lumen | visual | proxy |")
    print("|---|---|---|---|---|---|---|")
    for entry in parser.parse_args().colons:
        name, _, file = entry.partition("=")
        stage = read_colon(assets_dir() / name / "colon.usda")
        lumen = scanned_lumen(Path(file), stage) if file else generated_lumen(name, stage)
        cells = (f"{value:.2f}" for value in figures(stage, lumen, CANAL[bool(file)]))
        print("|", name, "|", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main()
