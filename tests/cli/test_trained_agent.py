# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A checkpoint's path is enough: the agent is the one that its run was trained with."""

from __future__ import annotations

from pathlib import Path

import pytest

from arcgym.cli.arguments import RunArguments
from arcgym.cli.task import load_run_cfgs
from arcgym.rl.run_folder import write_params
from arcgym.utils.registry import load_cfg_from_registry

TASK = "ARC-Rectum-Capsule"


@pytest.mark.parametrize("agent", ["ppo_recurrent", "ppo_masked", "sac"])
def test_the_agent_is_that_of_the_run(tmp_path: Path, agent: str) -> None:
    key = f"rsl_rl_{agent}_cfg_entry_point"
    agent_cfg = load_cfg_from_registry(TASK, key)
    env_cfg = load_cfg_from_registry(TASK, "env_cfg_entry_point")
    write_params(tmp_path, run={"task": TASK, "agent": key}, env=env_cfg, agent=agent_cfg)
    checkpoint = tmp_path / "model_0.pt"
    checkpoint.write_bytes(b"")
    _, found, path = load_run_cfgs(RunArguments(task=TASK, checkpoint=str(checkpoint)))
    assert type(found) is type(agent_cfg) and path == checkpoint
