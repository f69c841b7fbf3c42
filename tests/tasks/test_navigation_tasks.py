# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The registered navigation tasks: names, configurations, what a user may change."""

from __future__ import annotations

import subprocess
import sys

import pytest

from arcgym.envs import mdp
from arcgym.utils.configclass import configclass, validate
from arcgym.utils.registry import list_tasks, load_cfg_from_registry
from arcgym_tasks.navigation.config.proximal.env_cfg import SplenicProximalEnvCfg

TASKS = [
    f"ARC-{segment}-{robot}{variant}"
    for segment in ("Rectum", "Sigmoid", "Descending", "Splenic")
    for robot in ("Capsule", "Magnetic", "Proximal")
    for variant in ("", "-Play")
]


def test_all_tasks_are_registered() -> None:
    assert set(TASKS) <= set(list_tasks())


def test_listing_imports_neither_torch_nor_newton() -> None:
    code = "import sys, arcgym_tasks; print([m for m in ('torch', 'newton', 'warp') if m in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert result.stdout.strip() == "[]"


@pytest.mark.parametrize("task", TASKS)
def test_environment_config_is_complete(task: str) -> None:
    cfg = load_cfg_from_registry(task, "env_cfg_entry_point")
    validate(cfg)
    _, segment, robot = task.removesuffix("-Play").split("-")
    assert cfg.segment == segment.lower()
    assert robot.lower() in cfg.scene.endoscope.usd_path


@pytest.mark.parametrize("task", TASKS)
def test_agent_config_builds(task: str) -> None:
    cfg = load_cfg_from_registry(task, "rsl_rl_cfg_entry_point")
    _, segment, robot = task.removesuffix("-Play").split("-")
    assert cfg.experiment_name == f"arc_{segment.lower()}_{robot.lower()}"
    assert cfg.to_dict()["algorithm"]["gamma"] == 0.97


@pytest.mark.parametrize(
    ("segment", "steps"), [("Rectum", 100), ("Sigmoid", 450), ("Descending", 160), ("Splenic", 270)]
)
def test_horizon_is_counted_in_control_steps_of_a_tenth_second(segment: str, steps: int) -> None:
    cfg = load_cfg_from_registry(f"ARC-{segment}-Magnetic", "env_cfg_entry_point")
    step = cfg.decimation * cfg.sim.dt
    assert step == pytest.approx(0.1)
    assert round(cfg.episode_length_s / step) == steps


def test_play_has_few_worlds_and_no_randomization() -> None:
    train = load_cfg_from_registry("ARC-Sigmoid-Magnetic", "env_cfg_entry_point")
    play = load_cfg_from_registry("ARC-Sigmoid-Magnetic-Play", "env_cfg_entry_point")
    assert play.scene.num_envs < train.scene.num_envs
    assert play.events.light is None and play.events.reset is not None
    assert train.events.light is not None


def test_policy_sees_images_only() -> None:
    cfg = load_cfg_from_registry("ARC-Splenic-Proximal", "env_cfg_entry_point")
    terms = {name: term for name, term in vars(cfg.observations.policy).items() if hasattr(term, "func")}
    assert list(terms) == ["rgb"] and terms["rgb"].history_length == 5


def test_a_user_can_subclass_and_switch_terms_off() -> None:
    @configclass
    class MyEnvCfg(SplenicProximalEnvCfg):
        def __post_init__(self) -> None:
            super().__post_init__()
            self.rewards.progress = None
            self.lumen = "metric"

    cfg = MyEnvCfg()
    validate(cfg)
    assert cfg.rewards.progress is None and cfg.rewards.lumen is not None
    assert SplenicProximalEnvCfg().rewards.progress is not None


def test_own_reward_constants_are_accepted() -> None:
    cfg = SplenicProximalEnvCfg()
    cfg.lumen = mdp.LumenCfg(mix=0.5)
    validate(cfg)


def test_unknown_names_are_refused() -> None:
    cfg = SplenicProximalEnvCfg()
    cfg.segment = "spleen"
    with pytest.raises(ValueError, match="'spleen'.*rectum.*splenic"):
        validate(cfg)
    cfg = SplenicProximalEnvCfg()
    cfg.lumen = "papper"
    with pytest.raises(ValueError, match="papper.*metric.*paper"):
        validate(cfg)
