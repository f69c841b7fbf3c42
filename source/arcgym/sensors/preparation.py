# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Stool and fluid in the pictures of all worlds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import torch
import warp as wp

from arcgym.anatomy.segments import SEGMENTS
from arcgym.sensors.preparation_kernels import Residue, soil
from arcgym.sim.weight_cfg import WeightCfg

if TYPE_CHECKING:
    from arcgym.anatomy.stage import VisualMesh
    from arcgym.assets.patient import Patient
    from arcgym.scene.interactive_scene import InteractiveScene
    from arcgym.sensors.preparation_cfg import PreparationCfg
    from arcgym.sensors.surface_renderer import SurfaceRenderer

PARTS = {"right": ("ascending", "cecum"), "transverse": ("splenic", "transverse", "hepatic")} | {
    "left": ("rectum", "sigmoid", "descending")
}
"""Parts of the colon that the Boston scale scores, with their segments; each flexure counts to the transverse colon."""


class Preparation:
    """Scores of all worlds, and what lays stool and fluid into pictures. N worlds.

    Both stay where they are on the wall while it moves; fluid also follows the patient's posture where things weigh.
    """

    def __init__(self, cfg: PreparationCfg, scene: InteractiveScene):
        """Allocate scores.

        Args:
            cfg: What there is at each score; its own scores are given.
            scene: The scene.
        """
        device, count = str(scene.device), scene.num_envs
        own = np.broadcast_to(np.array(cfg.scores, np.int32), (count, 3)).copy()
        self._scores = wp.array(own, dtype=int, device=device)
        self._seed = wp.array(np.arange(count, dtype=np.int32), dtype=int, device=device)
        self._grades = wp.array(np.column_stack([cfg.stool, cfg.liquid, cfg.turbidity]), dtype=wp.vec3, device=device)
        weight: WeightCfg = scene.sim.cfg.weight
        down = wp.vec3(*WeightCfg().gravity(weight.posture))
        still = wp.full(count, down, dtype=wp.vec3, device=device)
        self._gravity: wp.array = scene.sim.actuation.gravity if weight.enabled else still

    @property
    def settings(self) -> dict[str, torch.Tensor]:
        """``scores`` (N, 3) and ``seed`` (N,), views."""
        return {"scores": wp.to_torch(self._scores), "seed": wp.to_torch(self._seed)}

    def write(self, scores: torch.Tensor, seed: torch.Tensor, env_ids: torch.Tensor | None = None) -> None:
        """Set scores, shape (n, 3), and seeds, shape (n,), of some worlds."""
        worlds = slice(None) if env_ids is None else env_ids
        for array, value in ((self._scores, scores), (self._seed, seed)):
            wp.to_torch(array)[worlds] = value.to(torch.int32)

    def cover(
        self,
        renderer: SurfaceRenderer,
        patients: Sequence[Patient],
        visuals: Sequence[VisualMesh],
        env_id: int | None = None,
    ) -> None:
        """Let a renderer show it.

        Args:
            renderer: Renderer of all worlds, or of one.
            patients: Patients of its surface.
            visuals: Their visual meshes.
            env_id: World of a renderer of one; None for all.
        """
        worlds = slice(None) if env_id is None else slice(env_id, env_id + 1)
        residue = Residue()
        residue.rest = wp.array(_places(renderer, patients, visuals), dtype=wp.vec4, device=renderer.device)
        residue.scores, residue.seed = self._scores[worlds], self._seed[worlds]
        residue.gravity, residue.grades = self._gravity[worlds], self._grades

        def lay(poses: wp.array, drawn: wp.array) -> None:
            seen = [poses, renderer.rays, renderer.covered, renderer.optics.far]
            inputs = [renderer.view, residue, drawn, *seen]
            wp.launch(soil, renderer.shape, inputs=inputs, outputs=[renderer.radiance], device=renderer.device)

        renderer.soil = lay


def _places(renderer: SurfaceRenderer, patients: Sequence[Patient], visuals: Sequence[VisualMesh]) -> np.ndarray:
    """Return each vertex' place at rest [m] and the part of the colon it is of, shape (M, P, 4)."""
    part_of = np.array([[segment in PARTS[part] for part in PARTS].index(True) for segment in SEGMENTS])
    places = np.zeros((renderer.surface.num_vertices, len(visuals), 4), np.float32)
    for p, (patient, visual) in enumerate(zip(patients, visuals, strict=True)):
        part = part_of[patient.wall.segment[visual.skin_indices[:, 0]]]
        places[: len(visual.points), p] = np.column_stack([visual.points, part])
    return places
