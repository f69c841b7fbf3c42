# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a drive notes of a patient, and the table of it."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest
import torch

from arcgym.benchmarks.experts.measure import Attempt, attempt, row_of
from arcgym.benchmarks.experts.table import failures, read_rows, table
from arcgym.benchmarks.experts.ways import Ways, read_way
from arcgym.benchmarks.worlds import OUT_OF_TIME
from arcgym.cli.bench_experts import _missing
from arcgym.start_states.route import Entry, Route
from arcgym.utils.paths import assets_dir


def test_a_route_ends_without_progress_or_time() -> None:
    route = Route({"rectum": (0.0, 0.1), "sigmoid": (0.1, 0.4)}, until="sigmoid")
    assert route.advance(0.05, 1.0) == ["rectum"]
    route.watch(patience=3.0, max_time=9.0)
    assert route.running
    route.advance(0.054, 4.5)  # 4 mm in 3.5 s
    route.watch(patience=3.0, max_time=9.0)
    assert route.problem == "no progress in 3 s" and not route.running


def test_the_table_has_shares_medians_and_high_figures(tmp_path: Path) -> None:
    rows = []
    for patient, time, problem in (("a", 10.0, ""), ("b", 30.0, "no progress in 30 s")):
        route = Route({"rectum": (0.0, 0.1), "sigmoid": (0.1, 0.4)}, arc=0.2, problem=problem, held_by="1 N")
        route.entries = {"rectum": Entry(0.0, 0.0, 0.0, 0.0), "sigmoid": Entry(time, 1.0, 2.0, 3.0)}
        rows.append({"patient": patient, "robot": "capsule", "tissue": "paper", **row_of(route)})
    lines = table(rows).splitlines()
    assert lines[2].startswith("| capsule | paper | sigmoid | 2 of 2 | 20 (29) | 1.0 (1.0) | 2.0 (2.0) |")
    assert "| descending | 0 of 2 | – |" in lines[3]
    assert failures(rows) == "- b, capsule, paper: 0.20 of 0.40 m, in the sigmoid, no progress in 30 s; 1 N"


def test_a_line_that_was_cut_off_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    path.write_text('{"patient": "a"}\n{"patient": "b", "rob')
    assert read_rows(path) == [{"patient": "a"}]


def test_scopes_of_another_length_have_rows_of_their_own() -> None:
    route = Route({"rectum": (0.0, 0.1), "sigmoid": (0.1, 0.4)}, arc=0.2)
    shipped = {"patient": "a", "robot": "magnetic", "tissue": "paper", **row_of(route)}
    lines = table([shipped, {**shipped, "scope_length": 2.2}]).splitlines()
    assert [line.split(" | ")[0] for line in lines[2::7]] == ["| magnetic", "| magnetic of 2.2 m"]
    stages = [Path("a/colon.usda"), Path("b/colon.usda")]
    assert list(_missing([shipped], "magnetic", "paper", None, stages, 8)) == [stages[1:]]
    assert list(_missing([shipped], "magnetic", "paper", 2.2, stages, 8)) == [stages]


@pytest.mark.slow
def test_a_drive_that_was_cut_off_goes_on_from_the_kept_one(tmp_path: Path) -> None:
    rows: list[dict] = []
    for _ in range(2):  # the computing time is over after the first control step
        plan = Attempt("capsule", "paper", 1, 240.0, "cpu", deadline=0.0, halts=tmp_path)
        attempt(plan, [assets_dir() / "colon_1/colon.usda"], rows.append)
    assert [row["time"] for row in rows] == [0.1, 0.2]
    assert [row["problem"] for row in rows] == [OUT_OF_TIME] * 2
    assert [path.name for path in tmp_path.iterdir()] == ["colon_1-capsule-paper.npz"]


class _Place:
    """A state on the way."""

    def __init__(self, arc: float) -> None:
        self.arc, self.state = arc, {"joint_q": torch.tensor([arc, 1.0])}


def test_states_on_the_way_are_kept_once_and_read_in_order(tmp_path: Path) -> None:
    places = [[_Place(0.96)], []]
    drive, ways, folder = SimpleNamespace(trail=SimpleNamespace(places=places)), Ways(), tmp_path / "a"
    for arc in (0.96, 1.0, 1.0):
        if arc > places[0][-1].arc:
            places[0].append(_Place(arc))
        ways.keep(drive, 0, folder)  # type: ignore[arg-type]
        ways.keep(drive, 1, tmp_path / "b")  # type: ignore[arg-type]  # nothing on its way yet
    way = read_way(folder)
    assert list(way) == [0.96, 1.0] and not (tmp_path / "b").exists()
    assert way[1.0].arrays["joint_q"].tolist() == [1.0, 1.0]


def test_overrides_are_part_of_a_row_s_tissue() -> None:
    plan = Attempt("capsule", "paper", 4, 240.0, "cpu", overrides=("env.clinical=[all]",))
    assert plan.label == "paper env.clinical=[all]"
    assert Attempt("capsule", "paper", 4, 240.0, "cpu").label == "paper"
