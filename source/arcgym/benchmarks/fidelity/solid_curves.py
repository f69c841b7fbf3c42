# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Force and depth of the solid tube under the tip, kept in ``solid_curves.json`` since they take minutes.

Made by ``python -m arcgym.benchmarks.fidelity.solid_curves paper 10 10`` and so on: tissue, bricks around and along.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from arcgym.assets.materials import tissue_preset
from arcgym.benchmarks.fidelity.solid_indentation import QuarterTube, press
from arcgym.benchmarks.fidelity.tubes import HELD_SPACINGS, Tube, wall_measures
from arcgym.sim.simulation_cfg import ContactCfg

FILE = Path(__file__).with_name("solid_curves.json")
"""Curves by tissue and mesh: {"paper 10x10": {"depth": [m], "force": [N]}}."""
RADIUS, LENGTH = 0.0166456, 0.1625
"""Inner radius and free length of the tube [m]: those of :mod:`~.indenter` when the kept curves were made. They stay
what they are when the shipped colon changes."""
STAGE_THICKNESS = 0.002
"""Thickness of the wall where the tissue has none of its own [m]."""
TIP = 0.0066
"""Radius of the indenter [m]."""
DEPTHS = {"paper": np.arange(1.0e-3, 1.05e-2, 1.0e-3), "in_situ": np.arange(5.0e-4, 1.32e-2, 5.0e-4)}
"""Depths from the first touch [m]: up to 17 N and 1.9 N."""


def solid_curve(material: str, mesh: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the kept depths [m] and forces [N] of a tissue on a mesh, such as ``10x10``."""
    kept = json.loads(FILE.read_text())[f"{material} {mesh}"]
    return np.r_[0.0, kept["depth"]], np.r_[0.0, kept["force"]]


def thickness(material: str) -> float:
    """Return the thickness of the wall [m]."""
    return tissue_preset(material).thickness or STAGE_THICKNESS


def shipped_tube() -> Tube:
    """Return a tube of these measures with rings and sectors of the shipped mesh."""
    free = round(LENGTH / wall_measures().spacing)
    return Tube(LENGTH * (free + sum(HELD_SPACINGS)) / free, radius=RADIUS)


def measure(material: str, around: int, along: int) -> np.ndarray:
    """Return the forces on the tip at :data:`DEPTHS` [N].

    The tip's radius includes the skin that contact adds to a link.
    """
    preset = tissue_preset(material)
    assert preset.youngs_modulus is not None and preset.poissons_ratio is not None
    tube = QuarterTube(LENGTH, RADIUS, thickness(material), around, along)
    sphere = TIP + ContactCfg().wall_radius
    return press(tube, preset.youngs_modulus, preset.poissons_ratio, sphere, DEPTHS[material])


def main(material: str, around: str, along: str) -> None:
    """Measure a curve and keep it."""
    force = measure(material, int(around), int(along))
    kept = json.loads(FILE.read_text()) if FILE.exists() else {}
    depth = [round(d, 5) for d in DEPTHS[material].tolist()]
    kept[f"{material} {around}x{along}"] = {"depth": depth, "force": [round(f, 4) for f in force.tolist()]}
    FILE.write_text(json.dumps(kept, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
