#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Checks colon stages: schema, units, meshes, lumen, landmarks, anchors, skinning, and that the wall holds still.

Prints one line a check with its figure and bound; the exit status is 0 if all checks of all stages pass, else 1.
``--json`` adds a last line ``{"stages": [{"path", "ok", "checks": [{"name", "value", "bound", "ok"}]}]}``.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from arcgym.anatomy import ColonStage
    from arcgym.anatomy.validation.validate import Check

SKIN_TOLERANCE = 1e-5
"""Largest distance between the skinned surface at rest and the stage's [m]; single precision leaves about 1e-7."""

DRIFT_TOLERANCE = 1e-3
"""Largest displacement of the wall after a second without contact [m]."""

FAR_AWAY = 1.0
"""Height of the capsule while the wall is watched [m]: above every colon; below, the sphincter would draw it in."""


def main() -> int:
    """Parses the command line, checks the stages and returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stage", type=Path, nargs="+", help="stage files (colon.usda)")
    parser.add_argument("--json", action="store_true", help="print all figures as JSON in the last line")
    parser.add_argument("--no-physics", action="store_true", help="leave out the simulated second")
    args = parser.parse_args()
    reports = [check_stage(path, physics=not args.no_physics) for path in args.stage]
    if args.json:
        print(json.dumps({"stages": reports}, allow_nan=False))
    return 0 if all(report["ok"] for report in reports) else 1


def check_stage(path: Path, physics: bool) -> dict:
    """Checks one stage, printing as it goes, and returns its report."""
    print(path, flush=True)
    checks = []
    for check in all_checks(path, physics):
        print(f"  {'ok  ' if check.ok else 'FAIL'} {check}", flush=True)
        checks.append(check)
    rows = [{"name": c.name, "value": finite(c.value), "bound": c.bound, "ok": c.ok} for c in checks]
    ok = all(check.ok for check in checks)
    print(f"  {'passes' if ok else 'FAILS'}", flush=True)
    return {"path": str(path), "ok": ok, "checks": rows}


def finite(value: float) -> float | None:
    """Returns the value as a plain number, None where it is not finite, which JSON cannot say."""
    return float(value) if math.isfinite(value) else None


def all_checks(path: Path, physics: bool) -> Iterator[Check]:
    """Yields the checks of one stage; those that need a readable stage only if it is."""
    from arcgym.anatomy.validation.stage_checks import inspect_file

    stage, checks = inspect_file(str(path))
    yield from checks
    if stage is None:
        return
    yield from skinning_checks(stage)
    if physics and all(check.ok for check in checks):
        yield from physics_checks(path)


def skinning_checks(stage: ColonStage) -> Iterator[Check]:
    """Compares both visual surfaces, skinned to the wall at rest, with the stage's own points."""
    import numpy as np

    from arcgym.anatomy.validation.validate import Check
    from arcgym.sensors import SkinnedSurface

    for name, visual in (("render", stage.visual), ("proxy", stage.visual_proxy)):
        surface = SkinnedSurface(visual, stage.wall, 1, "cpu")
        error = np.linalg.norm(surface.points.numpy() - visual.points, axis=1).max()
        yield Check(f"{name} surface: skinning error at rest [m]", float(error), SKIN_TOLERANCE, at_least=False)


def physics_checks(path: Path) -> Iterator[Check]:
    """Loads the stage into Newton and watches the wall for one simulated second, the scope far outside."""
    import torch

    from arcgym.anatomy.validation.validate import Check
    from arcgym.assets import CAPSULE_CFG, ColonCfg
    from arcgym.scene import InteractiveScene, InteractiveSceneCfg
    from arcgym.sim import SimulationCfg

    with torch.inference_mode():
        colon = ColonCfg(usd_path=str(path.resolve()))
        scene = InteractiveScene(InteractiveSceneCfg(num_envs=1, colon=colon, endoscope=CAPSULE_CFG), SimulationCfg())
        sim = scene.sim
        sim.world_arrays()["joint_q"][:, 2] = FAR_AWAY
        sim.forward()
        sim.step(round(1.0 / sim.physics_dt))
        drift = float(scene["colon"].data.nodal_displacement.max())
        speed = float(scene["colon"].data.nodal_vel_w.norm(dim=-1).max())
        broken = int(sim.non_finite.sum())
    yield Check("physics: worlds with values that are not finite", broken, 0, at_least=False)
    yield Check("physics: wall displacement after 1 s [m]", drift, DRIFT_TOLERANCE, at_least=False)
    yield Check("physics: wall speed after 1 s [m/s]", speed, DRIFT_TOLERANCE, at_least=False)


if __name__ == "__main__":
    raise SystemExit(main())
