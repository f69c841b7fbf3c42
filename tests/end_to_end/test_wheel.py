# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a pip user gets: commands, tasks and assets from the wheel, in a folder without a checkout."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_code_and_assets_are_those_of_the_wheel(wheel_python):
    code = (
        "import arcgym, arcgym_tasks; from arcgym.utils.paths import assets_dir; print(arcgym.__file__, assets_dir())"
    )
    for path in wheel_python.check(code).split():
        assert str(wheel_python.executable.parents[1]) in path
        assert not Path(path).is_relative_to(ROOT)


@pytest.mark.parametrize(
    ("source", "installed", "pattern"),
    [
        ("source/arcgym", "arcgym", "**/*.py"),
        ("source/arcgym_tasks", "arcgym_tasks", "**/*.py"),
        ("assets/usd", "arcgym/data/usd", "**/*.*"),
    ],
)
def test_no_file_is_left_out_of_the_wheel(wheel_python, source, installed, pattern):
    packages = Path(wheel_python.check("import arcgym; print(arcgym.__file__)").strip()).parents[1]
    wanted = {path.relative_to(ROOT / source) for path in (ROOT / source).glob(pattern)}
    assert wanted
    assert wanted <= {path.relative_to(packages / installed) for path in (packages / installed).glob(pattern)}


def test_the_wheel_is_named_by_the_code_of_the_checkout(wheel_python):
    from arcgym.utils.source_digest import source_digest

    code = "from arcgym.envs.provenance import versions; print(versions()['arcgym code'])"
    assert wheel_python.check(code).strip() == source_digest("arcgym", "arcgym_tasks")


def test_list_names_the_tasks(wheel_python):
    result = wheel_python.arcgym("list", "sigmoid")
    assert result.returncode == 0, result.stderr
    assert "ARC-Sigmoid-Proximal-Play" in result.stdout


def test_every_command_has_help(wheel_python):
    commands = eval(wheel_python.check("from arcgym.cli.main import COMMANDS; print(list(COMMANDS))"))
    assert {"train", "play", "list", "preview", "bench fidelity", "bench soak"} <= set(commands)
    overview = wheel_python.arcgym("--help")
    for command in commands:
        assert f"  {command} " in overview.stdout
        result = wheel_python.arcgym(*command.split(), "--help")
        assert result.returncode == 0, result.stderr
        assert f"usage: arcgym {command}" in result.stdout


def test_mistake_is_answered_with_the_nearest_name(wheel_python):
    result = wheel_python.arcgym("bench", "throughput", "--task", "ARC-Splenic-Proxmal")
    assert result.returncode == 2
    assert "ARC-Splenic-Proximal" in result.stderr
    assert list(wheel_python.folder.iterdir()) == []


@pytest.mark.slow
def test_preview_draws_a_shipped_colon(wheel_python, tmp_path):
    colon = wheel_python.check("from arcgym.utils.paths import assets_dir; print(assets_dir() / 'colon_1/colon.usda')")
    result = wheel_python.arcgym("preview", colon.strip(), tmp_path / "page.png")
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "page.png").stat().st_size > 10_000


def test_gymnasium_makes_a_task_and_steps_it(wheel_python):
    code = """
import gymnasium, torch, arcgym_tasks
for make in (gymnasium.make, gymnasium.make_vec):
    env = make("ARC-Rectum-Capsule", num_envs=1, device="cpu", seed=0)
    env.reset()
    obs, reward, terminated, truncated, info = env.step(torch.zeros(env.action_space.shape))
    print(tuple(reward.shape), sorted(obs))
    env.close()
"""
    assert wheel_python.check(code).splitlines()[-2:] == ["(1,) ['critic', 'policy']"] * 2
