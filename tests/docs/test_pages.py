# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""README's robot, add_robot.md, add_colon.md and importing.md, followed word by word in a folder of their own."""

from __future__ import annotations

from pathlib import Path

import pytest
from page import Page
from tiny import write_tiny_colon
from wheel import WheelPython

TINY_RUN = "--num_envs 2 --max_iterations 1 agent.num_steps_per_env=4 --device cpu"


@pytest.fixture
def colon(tmp_path: Path) -> Path:
    """A tube where the pages have a colon of one's own."""
    (tmp_path / "my_colon").mkdir()
    return write_tiny_colon(tmp_path / "my_colon", length=0.3)


def test_the_robot_of_the_readme_runs(tmp_path: Path, wheel_python: WheelPython) -> None:
    page = Page("README.md", tmp_path, wheel_python)
    assert list(page.files) == ["make_slim.py", "my_package/slim.py", "my_package/__init__.py"]
    page.run("python make_slim.py")
    told = page.run("arcgym zero --task ARC-Rectum-Slim --num_envs 1 --steps 2 --device cpu env.scene.colon.rigid=true")
    assert "ready after" in told


@pytest.mark.slow
def test_the_robot_of_the_readme_learns(tmp_path: Path, wheel_python: WheelPython) -> None:
    page = Page("README.md", tmp_path, wheel_python)
    page.run("python make_slim.py")
    command = page.command("arcgym train --task ARC-Sigmoid-Slim").replace("--num_envs 256", TINY_RUN)
    assert "start states: slim in colon_1: rectum, sigmoid" in page.run(command)
    assert list((tmp_path / "logs" / "rsl_rl" / "arc_sigmoid_slim").glob("*/model_*.pt"))


def test_a_robot_driven_in_a_new_way_is_one_file(tmp_path: Path, wheel_python: WheelPython) -> None:
    page = Page("docs/add_robot.md", tmp_path, wheel_python)
    assert "arcgym" not in "".join(str(path) for path in page.files)  # nothing inside the package
    command = page.command("arcgym zero --task ARC-Sigmoid-Jet --num_envs 1 --steps 2 env.start=rest")
    page.run(f"{command} --device cpu env.scene.colon.rigid=true")


@pytest.mark.slow
def test_every_command_of_add_robot_runs(tmp_path: Path, wheel_python: WheelPython) -> None:
    page = Page("docs/add_robot.md", tmp_path, wheel_python)
    told = [page.run(command) for command in page.commands()]
    assert "rectum, sigmoid" in told[1] and "made by" not in told[2]  # the second finds what the first has made
    assert "made by JetExpert" in told[3] and "made by" not in told[4]


def test_own_colon_gets_its_start_states(tmp_path: Path, wheel_python: WheelPython, colon: Path) -> None:
    page = Page("docs/add_colon.md", tmp_path, wheel_python)
    command = page.command("arcgym zero --task ARC-Sigmoid-Capsule")
    assert "start states: capsule in my_colon: rectum, sigmoid" in page.run(f"{command} --device cpu")


@pytest.mark.slow
def test_the_colon_of_add_colon_is_made(tmp_path: Path, wheel_python: WheelPython) -> None:
    page = Page("docs/add_colon.md", tmp_path, wheel_python)
    page.run_python()
    page.run("arcgym validate my_colon/colon.usda --no-physics")


@pytest.mark.slow
def test_an_imported_colon_can_be_trained_in(tmp_path: Path, wheel_python: WheelPython, colon: Path) -> None:
    page = Page("docs/importing.md", tmp_path, wheel_python)
    command = page.command("arcgym train --task ARC-Sigmoid-Magnetic")
    assert "start states: magnetic in my_colon" in page.run(f"{command} {TINY_RUN}")
