# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Trials of a suite for a study's policies. The processes here train and evaluate nothing."""

from __future__ import annotations

import sys

import pytest

from arcgym.cli.study import report_trials
from arcgym.rl.checkpoint import file_sha256
from arcgym.studies.cell import Cell
from arcgym.studies.launch import LaunchOptions, all_cells, launch
from arcgym.studies.study_cfg import StudyCfg
from arcgym.studies.suite_trials import SuiteTrials, all_trials, seeds_of
from arcgym.utils.configclass import validate

TASK = "ARC-Rectum-Magnetic"

TRAIN = """
import pathlib, sys
run = pathlib.Path(sys.argv[1])
run.mkdir()
(run / "model_0.pt").write_text(sys.argv[1])
"""

EVALUATE = """
import json, pathlib, sys
out, *hashes = sys.argv[1:]
out = pathlib.Path(out)
begun = (out / "run.json").is_file()
(out / "run.json").write_text(json.dumps({"checkpoint_sha256": hashes}))
(out / "trials.csv").write_text("trial\\n0\\n" + "1\\n" * begun)
if begun:
    (out / "summary.md").touch()
"""


@pytest.fixture(autouse=True)
def stand_in(monkeypatch):
    """Let cells write a checkpoint, and evaluations a trial a call, of which the second is the last."""
    train = Cell.command

    def command(self, device):
        words = train(self, device)
        return [sys.executable, "-c", TRAIN, words[words.index("--log_dir") + 1]]

    def evaluate(self, device):
        hashes = [file_sha256(cell.checkpoint()) for cell in self.cells]
        return [sys.executable, "-c", EVALUATE, str(self.folder), *hashes]

    monkeypatch.setattr(Cell, "command", command)
    monkeypatch.setattr(SuiteTrials, "command", evaluate)


def test_trials_wait_for_all_seeds_and_go_on_where_they_stopped(tmp_path, capsys):
    """Two seeds of two algorithms: two result folders, of one trial after the first call and two after the second."""
    cfg = StudyCfg(name="s", task=TASK, suites=["paper"], grid={"seed": [1, 2], "algorithm": ["ppo", "a2c"]})
    states = []
    for _ in range(2):
        cells = launch(cfg, tmp_path, LaunchOptions())
        found = all_trials(cells)
        assert [one.name for one in found] == ["rectum-magnetic_ppo_seed1+2", "rectum-magnetic_a2c_seed1+2"]
        states.append([(one.state(), one.rows()) for one in found])
    assert states == [[("begun", 1)] * 2, [("finished", 2)] * 2]
    assert report_trials(cells) == 0
    assert "trials of paper: 2 finished" in capsys.readouterr().out


def test_trials_of_another_checkpoint_are_named_and_not_counted(tmp_path, capsys):
    cfg = StudyCfg(name="s", task=TASK, suites=["paper"])
    for _ in range(2):
        cells = launch(cfg, tmp_path, LaunchOptions())
    assert report_trials(cells) == 0
    cells[0].checkpoint().write_text("trained further")
    assert report_trials(cells) == 3
    assert "trials/paper/rectum-magnetic_ppo_seed1: of other policies" in capsys.readouterr().out


def test_cells_that_are_not_finished_have_no_trials_yet(tmp_path):
    cells = [Cell(tmp_path, TASK, "ppo", seed, suites=("paper",)) for seed in (2, 1)]
    assert seeds_of(cells) == {"rectum-magnetic_ppo_seed": [1, 2]}
    (trials,) = all_trials(cells)
    assert trials.state() == "waiting" and [cell.seed for cell in trials.cells] == [1, 2]


def test_the_command_names_suite_task_and_checkpoints(tmp_path, monkeypatch):
    monkeypatch.undo()
    cells = tuple(Cell(tmp_path, TASK, "ppo", seed) for seed in (1, 2))
    for cell in cells:
        (cell.folder / "run_1").mkdir(parents=True)
        (cell.folder / "run_1" / "model_3.pt").touch()
    words = SuiteTrials("paper", cells).command("cuda:1")
    assert words[words.index("--tasks") + 1] == TASK and words[-2:] == ["--device", "cuda:1"]
    assert words[words.index("--agent") + 1].split(",") == [str(cell.folder / "run_1/model_3.pt") for cell in cells]
    assert words[words.index("--out") + 1] == str(tmp_path / "trials" / "paper" / "rectum-magnetic_ppo_seed1+2")


def test_a_cell_takes_part_in_those_of_its_suites_that_have_its_task(tmp_path):
    suites = ["population", "population_cecum", "ct"]
    grid = {"task": ["LeftColon", "Cecum", "rectum"], "algorithm": ["a2c", "ppo"]}
    cfg = StudyCfg(name="s", robot="Capsule", grid=grid, algorithms={"ppo": {"suites": suites}})
    found = all_trials(all_cells(cfg, tmp_path))
    assert [(one.name, one.suite) for one in found] == [
        ("leftcolon-capsule_ppo_seed1", "population"),
        ("leftcolon-capsule_ppo_seed1", "ct"),
        ("cecum-capsule_ppo_seed1", "population_cecum"),
        ("cecum-capsule_ppo_seed1", "ct"),
    ]


def test_unknown_suites_are_refused():
    cfg = StudyCfg(name="s", task=TASK, algorithms={"ppo": {"suites": ["papers"]}})
    with pytest.raises(ValueError, match="has 'papers'. Did you mean 'paper'"):
        validate(cfg, "study")
