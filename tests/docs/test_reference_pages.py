# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The pages that the documentation makes from the code leave nothing out."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from arcgym.envs import mdp
from arcgym.utils.reference import terms_of
from arcgym.utils.registry import list_tasks, load_cfg_from_registry

EXTENSIONS = Path(__file__).parents[2] / "docs" / "_ext"


@pytest.fixture(scope="module")
def pages() -> Iterator[dict[str, str]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(EXTENSIONS))
        import reference_configs
        import reference_tasks
        import reference_terms

        yield {
            "terms": reference_terms.page(),
            "tasks": reference_tasks.tasks_page(),
            "actions": reference_tasks.actions_page(),
            "observations": reference_tasks.observations_page(),
            "classes": reference_configs.classes_page(),
            "paths": reference_configs.paths_page(),
        }
    for name in ("reference_configs", "reference_tasks", "reference_terms", "markdown"):
        sys.modules.pop(name, None)


def cfg_of(task: str = "ARC-Sigmoid-Proximal") -> Any:
    return load_cfg_from_registry(task, "env_cfg_entry_point")


def section(page: str, title: str) -> str:
    """The text below a heading of level two."""
    (found,) = re.findall(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", page, re.DOTALL | re.MULTILINE)
    return found


def test_every_term_and_parameter_is_listed_once(pages: dict[str, str]) -> None:
    for term in terms_of(mdp):
        (found,) = re.findall(rf"^### `{term.name}`\n(.*?)(?=^##|\Z)", pages["terms"], re.DOTALL | re.MULTILINE)
        assert all(f"| `{param.name}` | `{param.default}` |" in found for param in term.params)


def test_every_task_is_listed_with_its_time_limit(pages: dict[str, str]) -> None:
    shipped = [task for task in list_tasks() if type(cfg_of(task)).__module__.startswith("arcgym_tasks.")]
    assert len(shipped) >= 24
    for task in shipped:
        if not task.endswith("-Play"):
            assert f"| `{task}` | 0.1 s | {cfg_of(task).max_episode_length_s:g} s," in pages["tasks"]


@pytest.mark.parametrize("manager", ["rewards", "terminations", "events", "costs", "metrics"])
def test_every_term_of_the_tasks_is_listed(pages: dict[str, str], manager: str) -> None:
    found = section(pages["tasks"], manager.capitalize())
    assert re.findall(r"^\| `(\w+)` \|", found, re.MULTILINE) == list(vars(getattr(cfg_of(), manager)))
    assert "The same in every task" in found
    assert ("`ARC-Withdrawal-Magnetic`" in found) == (manager in ("rewards", "terminations", "metrics"))


def test_weights_are_those_of_the_configuration(pages: dict[str, str]) -> None:
    found = section(pages["tasks"], "Rewards")
    assert cfg_of().rewards.progress.weight == 300.0
    assert re.search(r"^\| `progress` \| `progress` \|  \| `weight=300` \|", found, re.MULTILINE)


def test_axes_stand_in_the_order_of_the_action(pages: dict[str, str]) -> None:
    rows = re.findall(r"^\| (\d) \| `\w+` \| (\w+) \| (\S+) \| (\S+) \|$", section(pages["actions"], "Proximal"), re.M)
    assert rows == [
        ("0", "insertion", "0.05", "m/s"),
        ("1", "roll", "1", "rad/s"),
        ("2", "pitch", "1.3", "rad/s"),
        ("3", "yaw", "1.3", "rad/s"),
    ]


@pytest.mark.parametrize("robot", ["Capsule", "Magnetic", "Proximal"])
def test_entries_of_the_critic_follow_each_other(pages: dict[str, str], robot: str) -> None:
    critic = section(pages["observations"], robot).split("### Group `critic`")[1]
    size = int(re.search(r"`\((\d+),\)`", critic)[1])  # type: ignore[index]
    rows = re.findall(r"^\| (\d+)(?:–(\d+))? \| `(\w+)` \|", critic, re.MULTILINE)
    spans = [(int(first), int(last or first)) for first, last, _ in rows]
    assert [first for first, _ in spans] == [0, *(last + 1 for _, last in spans[:-1])] and spans[-1][1] == size - 1
    assert [name for *_, name in rows][:2] == ["lumen_direction", "centerline"]


def test_fields_are_found_by_class_and_by_path(pages: dict[str, str]) -> None:
    camera = re.search(r"^### EndoscopeCameraCfg\n(.*?)(?=^##)", pages["classes"], re.DOTALL | re.MULTILINE)
    assert camera is not None and "| `far` | `float` | `0.6` | Farthest distance seen [m]" in camera[1]
    assert "| `env.scene.camera.width` | `84` |" in pages["paths"]
    assert "| `agent.algorithm.gamma` | `0.97` |" in pages["paths"]
