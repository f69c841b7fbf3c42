# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Turn a CT segmentation or a surface of a colon into a stage that can be simulated. Needs ``arcgym[importer]``."""

from __future__ import annotations

import argparse
import importlib.util
import logging
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Any

from arcgym.cli.stopping import stopped_cleanly
from arcgym.utils.errors import UsageError

if TYPE_CHECKING:
    from arcgym.anatomy.importing import ImportSettings

PACKAGES = {"SimpleITK": "SimpleITK", "skimage": "scikit-image", "vtkmodules": "vtk", "matplotlib": "matplotlib"}
"""Modules of the extra ``importer`` and the packages that have them."""

UNCERTAIN = 40.0
"""Half the range of a border above which there is a warning [mm]: a third of a flexure's length."""

LONG_POUCH = 30.0
"""Length of a pouch above which there is a warning [mm]: haustra are shorter."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the input, the folder to make and the settings of the import."""
    parser.add_argument("input", type=Path, help=".mha .mha.gz .nii .nii.gz .nrrd, or .stl .obj .ply .vtk .vtp .glb")
    parser.add_argument("out", type=Path, help="folder that receives colon.usda, textures and report")
    parser.add_argument("--overwrite", action="store_true", help="replace the folder if it exists")
    parser.add_argument(
        "--keep-doubtful", action="store_true", help="make the folder although it is doubtful; exits with 1"
    )
    parser.add_argument("--preview", action="store_true", help="draw and open preview.png: outside, unrolled, inside")
    parser.add_argument(
        "--label", type=int, nargs="+", help="value or values of the colon, if there are several labels"
    )
    parser.add_argument(
        "--spacing", type=float, nargs=3, metavar=("X", "Y", "Z"), help="voxel spacing [mm], or factors"
    )
    parser.add_argument("--units", choices=("auto", "mm", "cm", "m"), default="auto", help="unit of a surface")
    parser.add_argument("--frame", choices=("auto", "ras", "lps", "y-up", "y-up-lps"), default="auto", help="its axes")
    parser.add_argument("--anus", metavar="X,Y,Z", help="place of the anus [mm], see docs/importing.md")
    parser.add_argument("--cecum", metavar="X,Y,Z", help="place of the cecal pole [mm]")
    parser.add_argument(
        "--landmark", action="append", default=[], metavar="NAME=MM", help="landmark by arc length, or X,Y,Z [mm]"
    )
    parser.add_argument("--posture", choices=("supine", "prone"), default="supine", help="how the patient lay")
    parser.add_argument("--licence", default="unknown", help="licence of the data, kept in the stage")
    parser.add_argument("--patient", default="unknown", help="patient in words, kept in the stage")
    parser.add_argument("--max-gap", type=float, default=50.0, help="longest gap to bridge [mm] (default: 50)")
    parser.add_argument("--min-lumen", type=float, default=8.0, help="least radius of the wall [mm] (default: 8)")
    parser.add_argument("--wall-thickness", type=float, default=2.0, help="thickness of the wall [mm] (default: 2)")
    parser.add_argument("--voxel", type=float, default=1.0, help="edge of the voxels worked on [mm] (default: 1)")
    parser.add_argument(
        "--rings", type=int, default=160, help="rings of the wall (default: 160, as in generated colons)"
    )
    parser.add_argument("--sectors", type=int, default=14, help="wall vertices around a ring (default: 14)")


def run(args: argparse.Namespace) -> int:
    """Check everything that can be checked before the work, import, and say what was made."""
    from arcgym.anatomy.importing import ColonImportError, ImportArgumentError, import_to_folder
    from arcgym.anatomy.importing.preflight import check_paths

    check_packages()
    try:
        check_paths(args.input, args.out, args.overwrite)
        settings = import_settings(args)
    except ImportArgumentError as error:
        raise UsageError(str(error)) from error
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    try:
        with stopped_cleanly(f"{args.out} was not made"):
            figures = import_to_folder(args.input, args.out, settings, args.overwrite)
    except ColonImportError as error:
        raise SystemExit(f"error: {error}") from error
    report(figures)
    if args.preview:
        show_preview(args.out)
    stage, radius = args.out / "colon.usda", figures["least_wall_radius_mm"]
    print(f"{stage}: {figures['length_mm']:.0f} mm, least wall radius {radius} mm")
    return 1 if figures["doubts"] else 0


def check_packages() -> None:
    """Check that the importer's packages are installed.

    Raises:
        UsageError: If one is missing.
    """
    missing = [package for module, package in PACKAGES.items() if importlib.util.find_spec(module) is None]
    if missing:
        raise UsageError(f"the importer needs {', '.join(missing)}: pip install 'arcgym[importer]'")


def report(figures: dict[str, Any]) -> None:
    """Print the doubts and the warnings."""
    for doubt in figures["doubts"]:
        print(f"doubtful: {doubt}")
    if figures["orientation"]["mirrored"]:
        print("warning: the mirror image is more like a colon; left and right may be exchanged in the file")
    if figures["anus"] == "only opening":
        print("the only opening of the surface was taken for the anus; if it is not, pass --anus")
    guessed = figures["guessed_landmarks"]
    if guessed:
        print(f"warning: landmarks at typical places: {', '.join(guessed)}; correct with --landmark")
    for name, half in figures["landmark_uncertainty_mm"].items():
        if half is not None and half > UNCERTAIN:
            at = figures["landmark_mm"][name]
            print(f"warning: {name} at {at:.0f} mm may be {half:.0f} mm off; correct with --landmark {name}=MM")
    for pouch in figures["cleaning"]["pouches"]:
        if pouch["length_mm"] > LONG_POUCH:
            print(f"warning: left at {pouch['place_mm']} mm: a pouch or a leak, {pouch['length_mm']} mm long")


def show_preview(folder: Path) -> None:
    """Draw the colon from outside, unrolled and from inside, and open the picture where there is a screen."""
    from arcgym.anatomy import read_colon
    from arcgym.viewers.colon_page import draw_page

    picture = folder / "preview.png"
    draw_page(read_colon(folder / "colon.usda")).save(picture)
    print(picture)
    webbrowser.open(picture.resolve().as_uri())


def import_settings(args: argparse.Namespace) -> ImportSettings:
    """Return the settings that the arguments state, in SI units.

    Raises:
        ImportArgumentError: If one cannot be right.
    """
    from arcgym.anatomy.importing import ImportSettings
    from arcgym.anatomy.importing.arguments import parse_landmark, parse_point

    return ImportSettings(
        name=args.out.name,
        label=args.label and tuple(args.label),
        spacing=args.spacing and tuple(args.spacing),
        units=args.units,
        frame=args.frame,
        anus=args.anus and parse_point(args.anus, "--anus"),
        cecum=args.cecum and parse_point(args.cecum, "--cecum"),
        landmarks=dict(parse_landmark(text) for text in args.landmark),
        posture=args.posture,
        licence=args.licence,
        patient=args.patient,
        keep_doubtful=args.keep_doubtful,
        max_gap=1e-3 * args.max_gap,
        voxel=1e-3 * args.voxel,
        min_lumen_radius=1e-3 * args.min_lumen,
        wall_thickness=1e-3 * args.wall_thickness,
        rings=args.rings,
        sectors=args.sectors,
    )
