# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Checks of a colon's stage that need the renderer or the simulation."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import torch

from arcgym.anatomy import ColonStage
from arcgym.anatomy.validation.checks import Check
from arcgym.assets import CAPSULE_CFG, ColonCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.scene.interactive_scene_cfg import InteractiveSceneCfg
from arcgym.sensors import SkinnedSurface
from arcgym.sim import SimulationCfg

SKIN_TOLERANCE = 1e-5
"""Largest distance between the skinned surface at rest and the stage's [m]; single precision leaves about 1e-7."""
DRIFT_TOLERANCE = 1e-3
"""Largest displacement of the wall after a second without contact [m]."""
FAR_AWAY = 1.0
"""Height of the capsule while the wall is watched [m]: above every colon; below, the sphincter would draw it in."""


def skinning_checks(stage: ColonStage) -> Iterator[Check]:
    """Compare both visual surfaces, skinned to the wall at rest, with the stage's own points."""
    for name, visual in (("render", stage.visual), ("proxy", stage.visual_proxy)):
        surface = SkinnedSurface(visual, stage.wall, 1, "cpu")
        error = np.linalg.norm(surface.points.numpy() - visual.points, axis=1).max()
        yield Check(f"{name} surface: skinning error at rest [m]", float(error), SKIN_TOLERANCE, at_least=False)


def physics_checks(path: Path) -> Iterator[Check]:
    """Load the stage into Newton and watch the wall for one simulated second, the scope far outside."""
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
