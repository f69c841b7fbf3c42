# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""``play.py --record`` on a real task, from the rest pose."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from arcgym.managers import load_episodes

ROOT = Path(__file__).resolve().parents[2]
PLAY = ["--task", "ARC-Rectum-Capsule", "--policy", "random", "--steps", "4", "--num_envs", "2", "--device", "cpu"]


def play(folder: Path, record: str) -> str:
    command = [sys.executable, str(ROOT / "scripts/rsl_rl/play.py"), *PLAY, "--record", record, "env.events.reset=null"]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=900)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.mark.slow
def test_unfinished_episodes_of_both_worlds_are_recorded(tmp_path):
    assert "recorded: 2 episodes in demos" in play(tmp_path, "demos")
    first, second = load_episodes(tmp_path / "demos")
    assert (first.info["length"], first.info["complete"], second.info["env_id"]) == (4, False, 1)
    assert first.data["forces/window"].shape == (4, 1, 3) and first.data["forces/tip_peak"].shape == (4,)
    assert first.data["poses/body_pos_w"].shape == (4, 1, 3) and "forces/link" not in first.data
    assert first.data["wall/strain"].shape[0] == first.data["rewards/total"].shape[0] == 4
    assert not np.array_equal(first.data["actions"], second.data["actions"])


@pytest.mark.slow
def test_one_hdf5_file(tmp_path):
    h5py = pytest.importorskip("h5py")
    assert "recorded: 2 episodes in all.hdf5" in play(tmp_path, "all.hdf5")
    with h5py.File(tmp_path / "all.hdf5") as file:
        assert file["data/demo_1/actions"].shape[0] == 4
        assert file["data"].attrs["total"] == 8
