#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Push a colonoscope through a mobile sigmoid colon, turn the shaft into an alpha loop, and straighten it.

python scripts/benchmarks/looping.py --out logs/looping --json_out looping.json

First a scripted expert pushes the tip past the sigmoid colon. It pushes on from there, once as before and once while
the shaft is rolled anticlockwise: the tip falls behind, and the loop crosses itself as seen from the front. Then the
tip is hooked and the shaft withdrawn, rolled clockwise as a colonoscopist does, not at all, and anticlockwise, each
from the same state.
Printed: looping ratio (inserted length over the tip's arc length), turning, writhe and crossings of shaft and colon,
forces. Draws the shaft from outside and the curves. Needs matplotlib (``pip install arcgym[dev]``).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import torch

from arcgym.assets import PROXIMAL_CFG, ColonCfg
from arcgym.benchmarks.looping.maneuver import LOOPING, maneuver
from arcgym.benchmarks.looping.pictures import draw_curves, save_views
from arcgym.scene import InteractiveScene, InteractiveSceneCfg
from arcgym.sim import SimulationCfg


def main() -> None:
    """Push, loop, straighten, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--colon", default="colon_1/colon.usda", help="stage of the colon")
    parser.add_argument("--material", default="in_situ", help="tissue preset")
    parser.add_argument("--mesocolon", type=float, help="height of the sigmoid mesocolon [m] (default: the preset's)")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--max_time", type=float, default=60.0, help="longest time of pushing [s]")
    parser.add_argument("--out", type=Path, help="folder for the pictures")
    parser.add_argument("--name", default="looping", help="first part of the pictures' names")
    parser.add_argument("--json_out", type=Path, help="file for the curves")
    args = parser.parse_args()
    slack = {} if args.mesocolon is None else {"sigmoid": args.mesocolon}
    colon = ColonCfg(usd_path=args.colon, material=args.material, anchor_slack=slack)
    scene = InteractiveScene(
        InteractiveSceneCfg(num_envs=1, colon=colon, endoscope=PROXIMAL_CFG), SimulationCfg(device=args.device)
    )
    runs, views = maneuver(scene, args.max_time)
    summary = {name: {"start": rows[0], "end": rows[-1]} for name, rows in runs.items()}
    if args.out:
        args.out.mkdir(parents=True, exist_ok=True)
        save_views(views, args.out / f"{args.name}_views.jpg")
        draw_curves(runs, LOOPING["time"], args.out / f"{args.name}_curves.png")
    if args.json_out:
        thinned = {name: [*rows[:-1:5], rows[-1]] for name, rows in runs.items()}
        about = {"colon": args.colon, "material": args.material, "mesocolon": args.mesocolon, "every_s": 0.5}
        args.json_out.write_text(json.dumps({**about, "runs": thinned}).replace("}, {", "},\n{") + "\n")
    print(json.dumps(summary))


if __name__ == "__main__":
    with torch.inference_mode():
        main()
