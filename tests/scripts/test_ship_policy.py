# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""``scripts/tools/ship_policy.py``: what it writes is found by a task of the robot, without the maker's patients."""

from __future__ import annotations

import json
import runpy
import subprocess
import sys
from hashlib import sha256
from pathlib import Path

import torch
from result_folders import write_result_folder

from arcgym.evaluation.trained_on import trained_on
from arcgym.rl.checkpoint import file_sha256, read_checkpoint
from arcgym.rl.params import read_params
from arcgym.rl.run_folder import write_params
from arcgym.utils.registry import load_cfg_from_registry

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "tools" / "ship_policy.py"
TASK = "ARC-Rectum-Magnetic"


def ship(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(SCRIPT), *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


def test_a_run_becomes_a_policy_of_its_robot(tmp_path: Path) -> None:
    env = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    env.scene.colon.usd_path = ["/home/me/patient_0/colon.usda"]
    env.log_dir = "/home/me/logs/rectum/run_1"
    env.events.friction.params = {"friction": (0.06, 0.16)}
    agent = load_cfg_from_registry(TASK, "rsl_rl_cfg_entry_point")
    agent.init_policy = str(_first_policy(tmp_path / "sigmoid"))
    run = tmp_path / "run"
    run.mkdir()
    write_params(run, run={"task": TASK, "agent": "rsl_rl_cfg_entry_point"}, env=env, agent=agent)
    contents = {"actor_state_dict": {"w": torch.ones(2)}, "iter": 3, "infos": {"transitions": 96}}
    torch.save(contents, run / "model_3.pt")
    (tmp_path / "curves.csv").write_text("iteration,success\n0,0.5\n")
    done = ship(str(run / "model_3.pt"), "--out", str(tmp_path / "policies"), "--curve", str(tmp_path / "curves.csv"))
    assert done.returncode == 0, done.stderr
    saved = read_params(tmp_path / "policies" / "rectum-magnetic")
    assert saved is not None and saved.task == TASK
    assert not {"usd_path", "num_patients"} & set(saved.env["scene"]["colon"])
    assert saved.env["log_dir"] == "rectum/run_1" and saved.agent["init_policy"] == "sigmoid/model_9.pt"
    weights = read_checkpoint(tmp_path / "policies" / "rectum-magnetic" / "model.pt")["actor_state_dict"]["w"]
    assert weights.dtype == torch.float16 and weights.tolist() == [1.0, 1.0]
    about = json.loads((tmp_path / "policies" / "rectum-magnetic" / "about.json").read_text())
    assert about["transitions"] == 96 and about["trained_on"] == ["patient_0/colon.usda"]
    first = {"policy": "sigmoid/model_9.pt", "task": "ARC-Sigmoid-Magnetic", "sha256": sha256(b"weights").hexdigest()}
    assert about["began_with"] == first
    assert about["trained_with"] == {"env.events.friction.params.friction": [0.06, 0.16]} and "events" not in saved.env
    shipped = tmp_path / "policies" / "rectum-magnetic" / "model.pt"
    assert trained_on(shipped) == ["patient_0/colon.usda"]
    assert about["sha256"] == file_sha256(tmp_path / "policies" / "rectum-magnetic" / "model.pt")
    assert (tmp_path / "policies" / "rectum-magnetic" / "curves.csv").is_file()
    _evaluations_are_of_the_shipped_file(tmp_path, about)


def _first_policy(run: Path) -> Path:
    """Write the run that the training begins with, and return its checkpoint."""
    run.mkdir()
    write_params(run, run={"task": "ARC-Sigmoid-Magnetic"}, env={}, agent={})
    (run / "model_9.pt").write_bytes(b"weights")
    return run / "model_9.pt"


def test_of_a_path_folder_and_file_are_kept() -> None:
    given = {"a": ["/home/me/runs/one/model.pt", "colon_1/colon.usda", "population:train"], "b": "C:\\me\\x\\y", "c": 3}
    kept = {"a": ["one/model.pt", "colon_1/colon.usda", "population:train"], "b": "x/y", "c": 3}
    assert runpy.run_path(str(SCRIPT))["without_folders"](given) == kept


def _evaluations_are_of_the_shipped_file(tmp_path: Path, about: dict[str, str]) -> None:
    """One of the run's own checkpoint is refused, one of the file that was written is put beside it."""
    for name, digest in (("own", about["made_from_sha256"]), ("shipped", about["sha256"])):
        write_result_folder(tmp_path / name, 3, checkpoint_sha256=[digest])
        done = ship("--evaluation", str(tmp_path / name), "--out", str(tmp_path / "policies"))
        if name == "own":
            assert done.returncode == 1 and "which is no file in" in done.stderr
        else:
            assert done.returncode == 0, done.stderr
    assert (tmp_path / "policies" / "rectum-magnetic" / "evaluation" / "shipped" / "trials.csv.gz").is_file()


def test_a_checkpoint_without_its_run_is_refused(tmp_path: Path) -> None:
    done = ship(str(tmp_path / "model_3.pt"))
    assert done.returncode == 1 and "has no params/, which names task and agent" in done.stderr
