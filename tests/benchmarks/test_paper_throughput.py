# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmarks that stand beside the paper's figures: the paper's table, and the picture of throughput."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "scripts" / "benchmarks"


def run(script: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(FOLDER / script), *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)


@pytest.fixture
def paper(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    import paper_throughput

    return paper_throughput


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (["--task", "ARC-Sigmoid-Proxmal"], "ARC-Sigmoid-Proximal"),
        (["--rollout", "16"], "--batch 1024 is more than a rollout of 16 steps in 1 worlds"),
        (["--num_envs", "1,five"], "'five' is no whole number"),
        (["agent.algorithm.learning_rat=1"], "learning_rate"),
    ],
)
def test_mistake_ends_before_anything_is_built(arguments, hint):
    result = run("paper_throughput.py", *arguments)
    assert result.returncode == 2
    assert hint in result.stderr
    assert "Traceback" not in result.stderr


def test_full_run_is_measured_and_a_short_one_extrapolated(paper):
    full = paper.figures(5, 51_200, 512.0, 112.0)
    assert full["extrapolated"] is False
    assert (full["env_steps_per_s"], full["collect_env_steps_per_s"]) == (100.0, 128.0)
    assert full["wall_s_44000"] == 440.0
    assert full["factor"] == pytest.approx(100.0 / 34.65)
    short = paper.figures(2, 200, 4.0, 1.0)
    assert (short["extrapolated"], short["wall_s_44000"], short["factor"]) == (True, 880.0, None)
    assert "EXTRAPOLATED" in paper.describe(short)
    assert "EXTRAPOLATED" not in paper.describe(full)


def test_settings_are_the_papers(paper):
    args = paper.make_parser().parse(["agent.algorithm.gamma=0.5"])
    env_cfg, agent_cfg = paper.load_cfgs(args, 5)
    assert env_cfg.sim.dt * env_cfg.decimation == pytest.approx(1.0 / 120.0)
    assert (env_cfg.scene.num_envs, agent_cfg.num_steps_per_env) == (5, 2048)
    assert (agent_cfg.algorithm.num_mini_batches, agent_cfg.algorithm.num_learning_epochs) == (10, 64)
    assert agent_cfg.algorithm.gamma == 0.5
    assert agent_cfg.obs_groups == {"actor": ["policy"], "critic": ["policy"]}


def test_picture_leaves_failed_rows_out(tmp_path):
    rows = [{"num_envs": n, "sim_s_per_wall_s": 0.5 * n} for n in (1, 64)] + [{"num_envs": 4096, "error": "memory"}]
    data = tmp_path / "throughput.json"
    data.write_text("a line before\n" + json.dumps({"device": "cuda:0 (A card)", "rows": rows}))
    result = run("plot_throughput.py", str(data), "--out", str(tmp_path / "throughput.png"))
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "throughput.png").stat().st_size > 1000


def test_other_json_is_refused(tmp_path):
    data = tmp_path / "other.json"
    data.write_text('{"rows": [{"value": 1}]}')
    result = run("plot_throughput.py", str(data), "--out", str(tmp_path / "throughput.png"))
    assert result.returncode == 2
    assert "other.json is no output of throughput.py" in result.stderr
