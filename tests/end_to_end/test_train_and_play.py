# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The scripts on real tasks: train, kill, resume, play."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import imageio.v3 as iio
import numpy as np
import pytest

from arcgym.rl import find_checkpoint
from arcgym.rl.checkpoint import read_checkpoint

ROOT = Path(__file__).resolve().parents[2]
TASK = ["--task", "ARC-Rectum-Proximal", "--num_envs", "1", "--device", "cpu"]
SMALL = ["agent.num_steps_per_env=4", "agent.algorithm.num_mini_batches=2", "agent.save_interval=1"]
LUMEN = "env.lumen=metric"
EXPERIMENT = ["--experiment_name", "trial"]


def command(script: str, *arguments: str) -> list[str]:
    return [sys.executable, "-u", str(ROOT / "scripts" / script), *TASK, *arguments]


def run(folder: Path, script: str, *arguments: str) -> str:
    result = subprocess.run(command(script, *arguments), cwd=folder, capture_output=True, text=True, timeout=900)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def path_after(output: str, name: str) -> Path:
    return Path(next(line for line in output.splitlines() if line.startswith(f"{name}: ")).split(": ", 1)[1])


@pytest.mark.slow
def test_train_then_play(tmp_path):
    trained = run(tmp_path, "rsl_rl/train.py", *EXPERIMENT, "--max_iterations", "1", *SMALL)
    checkpoint = path_after(trained, "checkpoint")
    assert checkpoint.is_file()
    assert {path.name for path in (checkpoint.parent / "params").iterdir()} == {"run.yaml", "env.yaml", "agent.yaml"}

    played = run(tmp_path, "rsl_rl/play.py", *EXPERIMENT, "--video", "--video_length", "4", "--steps", "4", LUMEN)
    assert "changed: env.lumen.mix: 0.6 -> 0.9" in played
    assert path_after(played, "checkpoint") == checkpoint
    assert {path.name for path in (checkpoint.parent / "exported").iterdir()} == {"policy.pt", "policy.onnx"}
    frames = iio.imread(path_after(played, "video"))
    assert len(frames) == 4
    assert all(frame.std() > 5.0 for frame in frames)
    assert np.abs(frames[-1].astype(int) - frames[0]).mean() > 0.1


@pytest.mark.slow
def test_kill_then_resume(tmp_path):
    arguments = [*EXPERIMENT, "--max_iterations", "1000", *SMALL]
    with subprocess.Popen(
        command("rsl_rl/train.py", *arguments), cwd=tmp_path, stdout=subprocess.PIPE, text=True
    ) as process:
        for line in process.stdout:
            if "Learning iteration 0/" in line:
                process.send_signal(signal.SIGTERM)
                break
        process.communicate(timeout=300)
    assert process.returncode == 128 + signal.SIGTERM
    checkpoint = find_checkpoint("trial", root=tmp_path / "logs" / "rsl_rl")
    done = read_checkpoint(checkpoint)["infos"]["completed_iterations"]
    resumed = run(tmp_path, "rsl_rl/train.py", *EXPERIMENT, "--resume", "--max_iterations", "1")
    assert f"at iteration {done}" in resumed
    assert "changed: agent.max_iterations: 1000 -> 1" in resumed
    assert path_after(resumed, "checkpoint").name == f"model_{done}.pt"


def test_zero_agent_runs(tmp_path):
    output = run(tmp_path, "zero_agent.py", "--steps", "2")
    assert "2 steps in" in output
