# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A wall of scattered vertices, as of a mesher: what the solver calls rings are bins along the centerline."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from scipy.spatial import Delaunay, cKDTree
from tiny import tiny_colon_stage
from tiny_sim import TinySim, steps

from arcgym.anatomy import ColonStage, VisualMesh, WallMesh, inner_faces, segment_index, write_colon
from arcgym.sim import Simulation, WallSolverCfg

LENGTH, RADIUS, THICKNESS, BINS = 0.20, 0.020, 0.002, 17
SIGMOID = segment_index("sigmoid")


def scattered_wall() -> WallMesh:
    """Vertices about 11 mm apart in no order, triangulated by Delaunay on the unrolled tube."""
    rng = np.random.default_rng(0)
    rows = np.linspace(0.0, LENGTH, 21)
    z, angle = np.meshgrid(rows, 2.0 * np.pi * np.arange(12) / 12, indexing="ij")
    angle = angle + np.pi / 12 * (np.arange(21) % 2)[:, None] + rng.uniform(-0.12, 0.12, z.shape)
    z[1:-1] += rng.uniform(-0.003, 0.003, z[1:-1].shape)
    order = np.lexsort((rng.random(z.size), z.ravel().round(2)))
    z, angle = z.ravel()[order], angle.ravel()[order] % (2.0 * np.pi)
    inner = np.stack([RADIUS * np.cos(angle), RADIUS * np.sin(angle), z], axis=1)
    outer = inner * [1.0 + THICKNESS / RADIUS, 1.0 + THICKNESS / RADIUS, 1.0]
    spacing = LENGTH / (BINS - 1)
    ring = np.tile(np.rint(z / spacing).astype(np.int32), 2)
    fixed = (ring < 3) | (ring >= BINS - 2)
    return WallMesh(
        points=np.concatenate([inner, outer]).astype(np.float32),
        tets=prisms(inner, outer, unrolled_triangles(z, angle)),
        anchor=np.where(fixed, 2, 0).astype(np.int32),
        segment=np.full(2 * len(z), SIGMOID, np.int32),
        ring=ring,
        layer=np.repeat([0, 1], len(z)).astype(np.int32),
        frame_neighbors=np.tile(nearest_around(z, angle), (2, 1)),
        ring_arc=(spacing * np.arange(BINS)).astype(np.float32),
    )


def unrolled_triangles(z: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Triangles over the seam of the unrolled tube come from copies a turn away, and are kept once."""
    turns = np.concatenate([angle - 2.0 * np.pi, angle, angle + 2.0 * np.pi])
    corners = Delaunay(np.column_stack([RADIUS * turns, np.tile(z, 3)])).simplices
    middle = turns[corners].mean(axis=1)
    return corners[(middle >= 0.0) & (middle < 2.0 * np.pi)] % len(z)


def prisms(inner: np.ndarray, outer: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Three tets under each triangle, split by ascending vertex, of positive volume."""
    a, b, c = np.sort(triangles, axis=1).T
    n = len(inner)
    tets = np.concatenate(
        [np.column_stack(t) for t in ((a, b, c, c + n), (a, b, b + n, c + n), (a, a + n, b + n, c + n))]
    )
    x = np.concatenate([inner, outer])[tets]
    inverted = np.linalg.det(x[:, 1:] - x[:, :1]) < 0.0
    tets[inverted] = tets[inverted][:, [1, 0, 2, 3]]
    return tets.astype(np.int32)


def nearest_around(z: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Vertices nearest to a step along and a step around, shape (V, 4)."""
    tree = cKDTree(np.column_stack([RADIUS * np.cos(angle), RADIUS * np.sin(angle), z]))
    steps = ((0.012, 0.0), (-0.012, 0.0), (0.0, 0.5), (0.0, -0.5))
    places = [(RADIUS * np.cos(angle + turn), RADIUS * np.sin(angle + turn), z + up) for up, turn in steps]
    return np.stack([tree.query(np.column_stack(place))[1] for place in places], axis=1).astype(np.int32)


def scattered_stage(folder: Path) -> ColonStage:
    stage, wall = tiny_colon_stage(LENGTH, RADIUS, BINS, capped=False, texture_folder=folder), scattered_wall()

    def bound(visual: VisualMesh) -> VisualMesh:
        """Every visual vertex hangs on the nearest wall vertex."""
        nearest = cKDTree(wall.points[wall.layer == 0]).query(visual.points)[1].astype(np.int32)
        weights = np.tile([1.0, 0.0, 0.0, 0.0], (len(nearest), 1)).astype(np.float32)
        return replace(visual, skin_indices=np.repeat(nearest[:, None], 4, axis=1), skin_weights=weights)

    return replace(stage, wall=wall, visual=bound(stage.visual), visual_proxy=bound(stage.visual_proxy))


@pytest.fixture(scope="module")
def scattered_sim(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    folder = tmp_path_factory.mktemp("scattered")
    sims = TinySim(folder)
    sims.colon_path = write_colon(scattered_stage(folder), folder / "colon.usda")
    return sims


def press(sim: Simulation, count: int) -> None:
    """Hold a capsule 3 mm deep in the wall, half way along the tube, for ``count`` steps."""
    sim.endoscope.data.joint_pos[0] = torch.tensor([0.0179, 0.0018, 0.1, 0.0, 0.0, 0.0, 1.0])
    sim.forward()
    for _ in range(count):
        sim.contact.detect(sim.nodal_pos, sim.state.body_q)
        sim.wall.step(sim.nodal_pos, sim.nodal_vel, sim.contact, sim.state.body_q, sim.state.body_q)


def test_the_scattered_tube_is_closed_and_has_no_rings() -> None:
    wall = scattered_wall()
    faces = inner_faces(wall.tets, wall.layer)
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, uses = np.unique(edges, axis=0, return_counts=True)
    # Every edge has two faces but the 12 at either end; the bins hold different numbers of vertices.
    assert (uses == 1).sum() == 24 and uses.max() == 2
    assert len(set(np.bincount(wall.ring))) > 2


@pytest.mark.parametrize("model", ["shell", "solid"])
def test_one_sweep_a_step_follows_a_scattered_wall(scattered_sim: TinySim, model: str) -> None:
    soft = {"youngs_modulus": 5.0e5, "wall_model": model}
    moved = []
    for cfg in (WallSolverCfg(), WallSolverCfg(repeats=8)):
        sim = scattered_sim("capsule", colon=soft, wall=cfg)
        press(sim, steps(sim, 0.1))
        moved.append(sim.colon.data.nodal_displacement.max().item())
    assert moved[1] > 1.0e-3
    assert moved[0] == pytest.approx(moved[1], rel=0.05)


def test_the_coarse_correction_helps_a_scattered_wall(scattered_sim: TinySim) -> None:
    def error(coarse: bool) -> float:
        """Share of the converged displacement that is missing after 24 sweeps, one a step."""
        moved = []
        for cfg in (WallSolverCfg(coarse_correction=coarse), WallSolverCfg(repeats=8)):
            sim = scattered_sim("capsule", colon={"youngs_modulus": 5.0e6}, wall=cfg)
            press(sim, 24)
            moved.append(sim.colon.data.nodal_displacement)
        return ((moved[0] - moved[1]).norm() / moved[1].norm()).item()

    assert error(True) < 0.3 * error(False)
