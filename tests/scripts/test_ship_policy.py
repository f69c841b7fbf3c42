# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""``scripts/tools/ship_policy.py``: what it writes is found by a task of the robot, without the maker's patients."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import torch

from arcgym.rl.checkpoint import read_checkpoint
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
    agent = load_cfg_from_registry(TASK, "rsl_rl_cfg_entry_point")
    run = tmp_path / "run"
    run.mkdir()
    write_params(run, run={"task": TASK, "agent": "rsl_rl_cfg_entry_point"}, env=env, agent=agent)
    torch.save({"actor_state_dict": {"w": torch.ones(2)}, "iter": 3, "infos": {}}, run / "model_3.pt")
    done = ship(str(run / "model_3.pt"), "--out", str(tmp_path / "policies"))
    assert done.returncode == 0, done.stderr
    saved = read_params(tmp_path / "policies" / "magnetic")
    assert saved is not None and saved.task == TASK
    assert not {"usd_path", "num_patients"} & set(saved.env["scene"]["colon"])
    weights = read_checkpoint(tmp_path / "policies" / "magnetic" / "model.pt")["actor_state_dict"]["w"]
    assert weights.dtype == torch.float16 and weights.tolist() == [1.0, 1.0]


def test_a_checkpoint_without_its_run_is_refused(tmp_path: Path) -> None:
    done = ship(str(tmp_path / "model_3.pt"))
    assert done.returncode == 1 and "has no params/, which names task and agent" in done.stderr
