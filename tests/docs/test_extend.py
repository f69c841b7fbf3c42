# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Walks the table "Where do I add ..." of architecture.md: each row's example, added from outside the package."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import torch

DOCS = Path(__file__).parents[2] / "docs"
ROWS = re.findall(r"^\| \[(.+?)\]\(extend\.md#(.+?)\) \|", (DOCS / "architecture.md").read_text(), re.MULTILINE)
SECTIONS = re.split(r"^## ", (DOCS / "extend.md").read_text(), flags=re.MULTILINE)[1:]


def a_reward(page: ModuleType) -> None:
    manager = page.env.reward_manager
    assert manager.get_term_cfg("calm").weight == -1.0
    speed = page.env.scene["endoscope"].data.tip_lin_vel_w.norm(dim=1)
    assert speed.min() > 0.0 and torch.equal(page.tip_speed(page.env), speed)


def an_observation(page: ModuleType) -> None:
    height = page.env.scene["endoscope"].data.tip_pos_w[:, 2]
    critic = page.env.observation_manager.groups["critic"]
    names, ends = list(critic.shapes), np.cumsum([shape[0] for shape in critic.shapes.values()])
    column = ends[names.index("height")] - 1
    assert torch.allclose(page.obs["critic"][:, column], 10.0 * height)


def a_termination(page: ModuleType) -> None:
    assert page.env.termination_manager.get_term("too_fast").tolist() == [False, False]


def a_cost(page: ModuleType) -> None:
    speed = page.tip_speed(page.env)
    assert torch.allclose(page.extras["costs"]["speed"], speed * page.env.step_dt)


def a_metric(page: ModuleType) -> None:
    assert torch.allclose(page.env.metrics_manager.get_value("top_speed"), page.tip_speed(page.env))


def an_event(page: ModuleType) -> None:
    first, second = page.env.scene["camera"]._looks.light_gain.numpy().tolist()
    assert 0.4 <= first < 0.6 and 0.4 <= second < 0.6 and first != second


def a_curriculum(page: ModuleType) -> None:
    assert page.env.curriculum_manager.active_terms == ["speed_limit"]
    assert page.env.termination_manager.get_term_cfg("too_fast").params["limit"] == pytest.approx(5.0, abs=1e-2)


def a_recorder(page: ModuleType) -> None:
    assert "height" in page.env.recorder_manager.active_terms


def a_sensor(page: ModuleType) -> None:
    read = page.env.scene["gyroscope"].data.angular_velocity
    assert torch.equal(read, page.env.scene["endoscope"].data.tip_ang_vel_w)


def a_robot(page: ModuleType) -> None:
    assert Path(page.env.scene.endoscope.cfg.usd_path).name == "pill.usda"
    assert page.env.scene.endoscope.actuator("tip").cfg.force_limit == 0.5


def a_drive(page: ModuleType) -> None:
    assert list(page.env.scene.endoscope.actuators) == ["tip", "ballast"]


def an_action(page: ModuleType) -> None:
    assert page.env.action_manager.total_action_dim == 1
    assert page.env.action_manager.get_term("forward").processed_actions.tolist() == [pytest.approx([0.04])] * 2


def a_colon(page: ModuleType) -> None:
    assert page.env.scene.colon.stage.name == "tiny"


def an_algorithm(page: ModuleType) -> None:
    from arcgym.rl import OnPolicyRunner, RslRlVecEnvWrapper

    page.agent.num_steps_per_env = 2
    runner = OnPolicyRunner(RslRlVecEnvWrapper(page.env), page.agent.to_dict(), log_dir=None, device="cpu")
    runner.learn(1)
    assert isinstance(runner.alg, page.CarefulPPO) and runner.alg.updates == 1


def a_picture(page: ModuleType) -> None:
    assert page.env.render().shape == (4 * 84, 4 * 84, 3)


def a_task(page: ModuleType) -> None:
    from arcgym.utils.registry import cfg_keys, load_cfg_from_registry

    agent = load_cfg_from_registry("My-Rectum-Play", "rsl_rl_careful_cfg_entry_point")
    assert isinstance(agent.algorithm, page.CarefulPpoCfg) and agent.experiment_name == "my_rectum_careful"
    assert "rsl_rl_sac_cfg_entry_point" in cfg_keys("My-Rectum")


WALK: dict[str, Callable[[ModuleType], None]] = {
    "A reward": a_reward,
    "An observation": an_observation,
    "A termination": a_termination,
    "A cost": a_cost,
    "A metric": a_metric,
    "An event": an_event,
    "A curriculum": a_curriculum,
    "A recorder": a_recorder,
    "A sensor": a_sensor,
    "A robot": a_robot,
    "A drive": a_drive,
    "An action": an_action,
    "A colon": a_colon,
    "A task": a_task,
    "A picture": a_picture,
    "An algorithm": an_algorithm,  # the last: it steps the environment on
}


def test_every_row_has_an_example_and_a_test() -> None:
    titles = [section.splitlines()[0] for section in SECTIONS]
    assert {row for row, _ in ROWS} == set(titles) == set(WALK)
    assert [anchor for _, anchor in ROWS] == [row.lower().replace(" ", "-") for row, _ in ROWS]
    assert all("```python" in section for section in SECTIONS)


@pytest.mark.parametrize("row", WALK)
def test_row(row: str, extended: ModuleType) -> None:
    WALK[row](extended)


def test_a_subclass_in_the_page_of_rewards_configures_the_terms() -> None:

    blocks = re.findall(r"^```python\n(.*?)^```", (DOCS / "add_reward.md").read_text(), re.DOTALL | re.MULTILINE)
    page: dict = {"__name__": __name__}
    for block in blocks:
        exec(compile(block, "add_reward.md", "exec"), page)
    cfg = page["GentleEnvCfg"](segment="rectum")
    assert cfg.rewards.bending.weight == -0.05 and cfg.rewards.progress is None
    assert "scale" in page["bending_over"].expected_params
