# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Stand-ins for a population: the same grid, other shapes, and start states that fit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tiny import write_tiny_colon
from tiny_sim import TinySim

from arcgym.anatomy import ColonStage, read_colon, write_colon
from arcgym.benchmarks.throughput import stand_ins as made_by
from arcgym.benchmarks.throughput.stand_ins import AMPLITUDE, displaced, moved_states, stand_ins
from arcgym.sim import SnapshotSet
from arcgym.sim.snapshot import fingerprint


def test_displacement_is_smooth_and_small_and_differs() -> None:
    line = np.stack([np.zeros(201), np.zeros(201), np.linspace(0.0, 0.2, 201)], axis=1)
    one, two = (displaced(line, number) - line for number in (1, 2))
    assert 0.3 * AMPLITUDE < np.abs(one).max() <= AMPLITUDE * 1.001 and np.abs(one - two).max() > 0.1 * AMPLITUDE
    # A wave of at least 100 mm has a slope of at most 2 pi 0.3 mm / 100 mm, 19 um in 1 mm.
    assert np.abs(np.diff(one, axis=0)).max() < 2.0e-5


def test_a_stand_in_that_another_process_made_meanwhile_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ARCGYM_CACHE", str(tmp_path / "cache"))
    (tmp_path / "tube").mkdir()
    tube = write_tiny_colon(tmp_path / "tube")

    def write_and_be_overtaken(colon: ColonStage, path: Path) -> None:
        write_colon(colon, path)
        theirs = path.parents[2] / "0001"
        theirs.mkdir()
        (theirs / "colon.usda").write_text("theirs")

    monkeypatch.setattr(made_by, "write_colon", write_and_be_overtaken)
    _, path = stand_ins(tube, 2)
    assert [(one.name, one.read_text()) for one in path.parent.iterdir()] == [("colon.usda", "theirs")]


def test_stand_ins_share_a_batch_with_their_colon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ARCGYM_CACHE", str(tmp_path / "cache"))
    (tmp_path / "tube").mkdir()
    tube = write_tiny_colon(tmp_path / "tube")
    paths = stand_ins(tube, 3)
    assert paths[0] == tube and paths == stand_ins(tube, 3)
    textures = [read_colon(path).albedo_texture.read_bytes() for path in paths]
    assert len(set(textures)) == 3 and textures[1].startswith(textures[0])
    sim = TinySim(tmp_path)("capsule", num_envs=3, colon={"usd_path": [str(path) for path in paths]})
    rests = [patient.wall.points for patient in sim.colon.patients]
    marks = [fingerprint(sim, index) for index in range(3)]
    states = SnapshotSet(("a",), (sim.read_snapshot(0),), marks[0])
    sim.load_snapshots(moved_states(states, rests, marks))
    sim.write_snapshot(0)
    assert sim.colon.data.nodal_displacement.max() < 1.0e-7
    sim.step(5)
    assert sim.colon.data.nodal_displacement.max() < 1.0e-5
