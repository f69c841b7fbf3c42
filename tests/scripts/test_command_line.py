# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

import pytest

from arcgym.cli.main import COMMANDS

ROOT = Path(__file__).resolve().parents[2]
HEAVY = {"torch", "newton", "warp", "mujoco", "rsl_rl", "pxr"}
BUDGET_S = 0.5


def program(script: str) -> list[str]:
    """Return the arguments of the interpreter that run a script, or ``arcgym``."""
    return ["-m", "arcgym"] if script == "arcgym" else [str(ROOT / "scripts" / script)]


def run(script: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a script, or ``python -m arcgym`` where the script is ``arcgym``."""
    command = [sys.executable, *program(script), *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)


def processor_time() -> float:
    """Processor time of all finished child processes [s]."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def start(*command: str) -> float:
    """Run a command that must not import what is heavy, and return the processor time that it took [s]."""
    before = processor_time()
    result = subprocess.run([sys.executable, "-X", "importtime", *command], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    imported = {line.split("|")[-1].strip() for line in result.stderr.splitlines() if line.startswith("import time:")}
    assert not HEAVY & imported
    return processor_time() - before


@pytest.mark.parametrize(
    ("script", "arguments"),
    [
        ("rsl_rl/train.py", ["--help"]),
        ("rsl_rl/play.py", ["--help"]),
        ("zero_agent.py", ["--help"]),
        ("random_agent.py", ["--help"]),
        ("arcgym", ["--help"]),
        *(("arcgym", [*name.split(), "--help"]) for name in COMMANDS),
    ],
)
def test_answers_without_heavy_imports(script, arguments):
    """The budget is on processor time, so that a busy machine does not count."""
    assert start(*program(script), *arguments) < BUDGET_S


@pytest.mark.parametrize(("script", "arguments"), [("list_envs.py", []), ("arcgym", ["list"])])
def test_a_list_of_tasks_takes_little_more_than_the_packages_that_it_needs(script, arguments):
    """Gymnasium, which keeps the tasks, imports numpy: on a slow machine these alone take half a second."""
    needed = start("-c", "import gymnasium, rich.console, rich.table")
    assert start(*program(script), *arguments) < 1.5 * needed


def test_list_envs_names_the_tasks():
    result = run("list_envs.py", "splenic")
    assert "ARC-Splenic-Proximal-Play" in result.stdout
    assert "ARC-Rectum-Capsule" not in result.stdout


def test_unknown_task_names_the_nearest():
    result = run("rsl_rl/train.py", "--task", "ARC-Splenic-Proxmal")
    assert result.returncode == 2
    assert "ARC-Splenic-Proximal" in result.stderr
    assert "Traceback" not in result.stderr


def test_unknown_flag_is_not_an_override():
    result = run("rsl_rl/train.py", "--task", "ARC-Splenic-Proximal", "--num_env=2")
    assert result.returncode == 2
    assert "'--num_env=2'. Did you mean '--num_envs'?" in result.stderr


def test_unknown_subcommand_names_the_nearest():
    result = run("arcgym", "trian")
    assert result.returncode == 2
    assert "'trian'. Did you mean 'train'?" in result.stderr


@pytest.mark.parametrize(
    ("override", "hint"),
    [("agent.algorithm.learning_rat=1e-4", "learning_rate"), ("env.scene.num_envs=many", "int")],
)
def test_bad_override_says_what_was_meant(override, hint):
    result = run("rsl_rl/train.py", "--task", "ARC-Splenic-Proximal", override)
    assert result.returncode == 2
    assert hint in result.stderr
    assert "Traceback" not in result.stderr


def test_a_command_ends_without_a_last_search_for_garbage() -> None:
    look = "import atexit, gc, sys; atexit.register(lambda: print('kept:', gc.get_freeze_count()))"
    code = f"{look}; sys.argv = ['arcgym', '--version']; from arcgym.cli.main import main; main()"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True).stdout
    assert int(said.rpartition("kept:")[2]) > 1000  # what was registered first is called last
