# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Cells as processes: what is run, left alone, waited for and reported. The processes here train nothing."""

from __future__ import annotations

import sys
import time

import pytest
from omegaconf import OmegaConf

from arcgym.cli.study import report
from arcgym.rl.first_episodes import read_rows
from arcgym.studies.cell import Cell, read_cells
from arcgym.studies.launch import LaunchOptions, all_cells, launch
from arcgym.studies.run_cell import run_cell
from arcgym.studies.study_cfg import StudyCfg
from arcgym.studies.table import cell_rows
from arcgym.utils.coerce import to_plain
from arcgym.utils.errors import UsageError

TASK = "ARC-Rectum-Magnetic"

CODE = """
import pathlib, sys, time
run = pathlib.Path(sys.argv[1])
run.mkdir()
(run / "model_0.pt").touch()
(run / "episodes.csv").write_text("world,success,seconds,progress,cost_x\\n0,1,2.0,1.0,0.5\\n1,0,4.0,0.5,0.0\\n")
print(sys.argv[1:], flush=True)
if "agent.fails=1" in sys.argv:
    print("no such thing")
    sys.exit(2)
if "agent.sleeps=1" in sys.argv:
    time.sleep(60)
"""


@pytest.fixture(autouse=True)
def stand_in(monkeypatch):
    """Let cells run :data:`CODE` with their folder and the end of their own command."""
    original = Cell.command

    def command(self, device):
        words = original(self, device)
        return [sys.executable, "-c", CODE, words[words.index("--log_dir") + 1], str(device), *words[-2:]]

    monkeypatch.setattr(Cell, "command", command)


def states(cells):
    return {cell.algorithm: cell.read_state()["state"] for cell in cells}


def test_finished_cells_are_left_alone_and_failed_ones_are_run_again(tmp_path):
    cfg = StudyCfg(name="s", task=TASK, grid={"algorithm": ["ppo", "a2c"]}, algorithms={"a2c": {"agent": {"fails": 1}}})
    for _ in range(2):
        cells = launch(cfg, tmp_path, LaunchOptions(devices=("cpu",), per_device=2))
        assert states(cells) == {"ppo": "finished", "a2c": "failed"}
    assert [len(cell.runs) for cell in cells] == [1, 2]
    assert cells[1].read_state()["log"].endswith("no such thing")
    assert read_cells(tmp_path) == sorted(cells, key=lambda cell: cell.name)
    assert report(tmp_path, cells) == 1
    text = (tmp_path / "table.md").read_text()
    assert "rectum-magnetic_a2c_seed1: exit status 2" in text and "no such thing" in text


def test_the_table_is_of_first_episodes(tmp_path):
    """World 0 succeeded in 2 s, world 1 failed in 4 s: 50 %, 2 s to arrive, 3 s an episode."""
    cells = launch(StudyCfg(name="s", task=TASK), tmp_path, LaunchOptions())
    assert report(tmp_path, cells) == 0
    (row,) = read_rows(tmp_path / "table.csv")
    expected = {
        "episodes": 2.0,
        "success %": 50.0,
        "arrival s": 2.0,
        "episode s": 3.0,
        "progress": 0.75,
        "cost x": 0.25,
    }
    assert {name: row[name] for name in expected} == expected
    assert [row["cell"] for row in read_rows(tmp_path / "episodes.csv")] == ["rectum-magnetic_ppo_seed1"] * 2


def test_what_was_varied_is_shown_beside_a_figure_of_the_same_name(tmp_path):
    """The ablation varies env.reward, and the episodes of the table have a mean reward."""
    cell = Cell(tmp_path, TASK, "ppo", 1, {"env.reward": "s_1", "env.lumen": "paper"})
    (row,) = cell_rows(cell)
    assert row["env.reward"] == "s_1" and row["lumen"] == "paper" and "reward" in row


def test_the_table_keeps_the_cells_of_an_earlier_call(tmp_path):
    for seed in (1, 2):
        report(tmp_path, launch(StudyCfg(name="s", task=TASK, seed=seed), tmp_path, LaunchOptions()))
    assert sorted(row["seed"] for row in read_rows(tmp_path / "table.csv")) == [1.0, 2.0]


def test_a_cell_waits_for_the_one_it_comes_after(tmp_path):
    cfg = StudyCfg(
        name="s",
        task=TASK,
        grid={"algorithm": ["distillation", "ppo_teacher"]},
        algorithms={"distillation": {"after": "ppo_teacher", "agent": {"teacher_checkpoint": "{checkpoint}"}}},
    )
    cells = launch(cfg, tmp_path, LaunchOptions())
    assert states(cells) == {"distillation": "finished", "ppo_teacher": "finished"}
    assert "ppo_teacher_seed1/run_1/model_0.pt" in (cells[0].folder / "log.txt").read_text()


def test_a_cell_waits_for_ever_for_one_that_fails(tmp_path):
    cfg = StudyCfg(
        name="s",
        task=TASK,
        grid={"algorithm": ["distillation", "ppo_teacher"]},
        algorithms={"distillation": {"after": "ppo_teacher"}, "ppo_teacher": {"agent": {"fails": 1}}},
    )
    cells = launch(cfg, tmp_path, LaunchOptions())
    assert states(cells) == {"distillation": "waiting", "ppo_teacher": "failed"}


def test_cells_stop_when_the_time_is_over(tmp_path):
    cfg = StudyCfg(name="s", task=TASK, agent={"sleeps": 1}, grid={"algorithm": ["ppo", "sac"]})
    values = to_plain(cfg) | {"axes": [], "folder": str(tmp_path), "device": None}
    for algorithm, seconds in (("ppo", 2.0), ("sac", -1.0)):
        run_cell(OmegaConf.create(values | {"algorithm": algorithm, "stop_at": time.time() + seconds}))
    cells = all_cells(cfg, tmp_path)
    assert states(cells) == {"ppo": "stopped", "sac": "pending"}
    assert report(tmp_path, cells) == 3


def test_a_cell_goes_on_with_its_own_settings_alone(tmp_path):
    launch(StudyCfg(name="s", task=TASK, minutes=1.0), tmp_path, LaunchOptions())
    (cell,) = launch(StudyCfg(name="s", task=TASK, minutes=2.0), tmp_path, LaunchOptions())
    assert len(cell.runs) == 2
    with pytest.raises(UsageError, match="begun with other settings: num_envs None, now 8"):
        launch(StudyCfg(name="s", task=TASK, num_envs=8), tmp_path, LaunchOptions())


def test_a_cell_that_cannot_be_started_fails_alone(tmp_path, monkeypatch):
    original = Cell.command
    monkeypatch.setattr(
        Cell, "command", lambda self, device: ["/nowhere"] if self.seed == 1 else original(self, device)
    )
    cells = launch(StudyCfg(name="s", task=TASK, grid={"seed": [1, 2]}), tmp_path, LaunchOptions())
    assert [cell.read_state()["state"] for cell in cells] == ["failed", "finished"]
    assert "/nowhere" in cells[0].read_state()["log"]


def test_cells_share_the_devices(tmp_path):
    cfg = StudyCfg(name="s", task=TASK, grid={"seed": [1, 2, 3, 4]})
    cells = launch(cfg, tmp_path, LaunchOptions(devices=("cuda:0", "cuda:1")))
    logs = [(cell.folder / "log.txt").read_text() for cell in cells]
    assert {device for device in ("cuda:0", "cuda:1") for log in logs if f"'{device}'" in log} == {"cuda:0", "cuda:1"}
