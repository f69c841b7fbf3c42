# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Curves and pictures of cells whose files are written here."""

from __future__ import annotations

import imageio.v3 as imageio
import pytest
from torch.utils.tensorboard import SummaryWriter

from arcgym.rl.first_episodes import write_rows
from arcgym.studies.cell import Cell
from arcgym.studies.curves import COLUMNS, make_curves
from arcgym.studies.figures import _curve, draw_curves, draw_pareto

pytest.importorskip("matplotlib")


@pytest.fixture
def cell(tmp_path) -> Cell:
    made = Cell(tmp_path, "ARC-Rectum-Magnetic", "ppo", 1)
    made.write_state("finished")
    return made


def log(cell: Cell, run: int, first: int, values: list[float]) -> None:
    with SummaryWriter(str(cell.folder / f"run_{run}")) as writer:
        for iteration, value in enumerate(values, start=first):
            for tag in COLUMNS.values():
                writer.add_scalar(tag, value, iteration)
            writer.add_scalar("Episode_Cost/tip_force", 2.0 * value, iteration)


def test_a_resumed_run_replaces_what_was_lost(cell):
    """The first run made iterations 0 to 3, its last checkpoint was of iteration 1: the second begins with 2."""
    log(cell, 1, 0, [1.0, 2.0, 3.0, 4.0])
    log(cell, 2, 2, [30.0, 40.0, 50.0])
    rows = make_curves(cell)
    assert [(row["iteration"], row["reward"]) for row in rows] == [(0, 1.0), (1, 2.0), (2, 30.0), (3, 40.0), (4, 50.0)]
    assert [row["cost_tip_force"] for row in rows] == [2.0, 4.0, 60.0, 80.0, 100.0]


def test_curves_are_means_over_a_twentieth(cell):
    """Of 40 points each is the mean with the one before it: 0, 0.5, 1.5, ..."""
    write_rows(cell.folder / "curves.csv", [{"transitions": 10 * i, "success": i} for i in range(40)])
    x, y = _curve(cell, "transitions", "success")
    assert x.tolist()[:3] == [0.0, 10.0, 20.0]
    assert y.tolist()[:3] == [0.0, 0.5, 1.5]


def test_pictures_show_the_cell(cell, tmp_path):
    curve = [{"transitions": i, "seconds": i, "success": 0.5, "reward": 1.0} for i in range(5)]
    write_rows(cell.folder / "curves.csv", curve)
    run = cell.folder / "run_1"
    run.mkdir()
    write_rows(run / "episodes.csv", [{"world": 0, "success": 1, "seconds": 2.0, "tip_time_above_unsafe": 0.5}])
    for draw, name in ((draw_curves, "curves.png"), (draw_pareto, "pareto.png")):
        draw([cell], tmp_path / name, "one")
        with_cell = imageio.imread(tmp_path / name)
        (run / "episodes.csv").rename(run / "away")
        (cell.folder / "curves.csv").rename(run / "curves")
        draw([cell], tmp_path / name, "one")
        assert (imageio.imread(tmp_path / name) != with_cell).any()
        (run / "away").rename(run / "episodes.csv")
        (run / "curves").rename(cell.folder / "curves.csv")
