# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A training run of two processes on the CPU, started as users start it."""

from __future__ import annotations

import subprocess
import sys

import pytest
import torch

SMALL = [
    "env.scene.colon.rigid=true",
    "env.scene.camera.width=40",
    "env.scene.camera.height=40",
    "agent.num_steps_per_env=4",
    "agent.algorithm.num_mini_batches=2",
]


@pytest.mark.slow
def test_two_processes_train_one_policy(tmp_path):
    """4 steps of 2 worlds in 2 processes, 2 iterations: 32 transitions. Rank 0 alone writes."""
    run = tmp_path / "run"
    command = [sys.executable, "-m", "torch.distributed.run", "--standalone", "--nproc_per_node", "2", "-m", "arcgym"]
    command += ["train", "--distributed", "--device", "cpu", "--task", "ARC-Rectum-Capsule", "--agent", "ppo_small"]
    command += ["--num_envs", "2", "--max_iterations", "2", "--log_dir", str(run), *SMALL]
    result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=500)
    assert result.returncode == 0, result.stderr[-2000:]
    infos = torch.load(run / "model_1.pt", weights_only=True)["infos"]
    assert infos["transitions"] == 32
    assert infos["completed_iterations"] == 2
    assert len(list(run.glob("events.*"))) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
