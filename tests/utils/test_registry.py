# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import importlib.metadata
import subprocess
import sys
import types

import gymnasium
import pytest

from arcgym.utils import configclass, registry


@configclass
class DemoCfg:
    size: int = 3


@pytest.fixture
def demo() -> str:
    name = "Demo-Task"
    registry.register_task(name, env_cfg_entry_point=f"{__name__}:DemoCfg")
    yield name
    del gymnasium.registry[name]


def test_configuration_is_fresh_each_time(demo: str) -> None:
    first = registry.load_cfg_from_registry(demo, "env_cfg_entry_point")
    first.size = 7
    assert registry.load_cfg_from_registry(demo, "env_cfg_entry_point").size == 3


def test_duplicate_name_raises(demo: str) -> None:
    with pytest.raises(ValueError, match="'Demo-Task' is registered already, with the configuration .*DemoCfg"):
        registry.register_task(demo, env_cfg_entry_point="other:Cfg")


def test_unknown_task_and_key_say_what_there_is(demo: str) -> None:
    known = len(registry.list_tasks(prefix=""))
    message = rf"Unknown task 'Demo-Tusk'. Did you mean 'Demo-Task'.*\? 'arcgym list' shows all {known}\."
    with pytest.raises(ValueError, match=message):
        registry.load_cfg_from_registry("Demo-Tusk", "env_cfg_entry_point")
    with pytest.raises(ValueError, match="has no 'rsl_cfg'.*Available: env_cfg_entry_point"):
        registry.load_cfg_from_registry(demo, "rsl_cfg")


def test_third_party_package_is_found_by_its_entry_point(monkeypatch: pytest.MonkeyPatch) -> None:
    module = types.ModuleType("elsewhere")
    monkeypatch.setitem(sys.modules, "elsewhere", module)
    entry = importlib.metadata.EntryPoint("mine", "elsewhere", registry.ENTRY_POINT_GROUP)
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: [entry])
    registry.load_task_packages()
    assert "elsewhere" in registry._loaded


def test_broken_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    entry = importlib.metadata.EntryPoint("mine", "no_such_package", registry.ENTRY_POINT_GROUP)
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: [entry])
    with pytest.raises(ImportError, match=r"task package 'no_such_package' \(entry point 'mine'"):
        registry.load_task_packages()


def test_listing_tasks_imports_neither_torch_nor_newton() -> None:
    code = "import sys; from arcgym.utils.registry import list_tasks; list_tasks(); "
    code += "print([name for name in ('torch', 'newton', 'warp') if name in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert result.stdout.strip() == "[]"


@pytest.mark.parametrize("plain, play", [("A-B", "A-B-Play"), ("A-B-v0", "A-B-Play-v0"), ("Play-v2", "Play-Play-v2")])
def test_the_variant_for_watching_is_known_before_a_version_too(plain: str, play: str) -> None:
    assert registry.play_task(plain) == registry.play_task(play) == play
    assert registry.plain_task(play) == registry.plain_task(plain) == plain
