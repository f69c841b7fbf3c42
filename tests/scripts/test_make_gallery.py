# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The gallery's page, and the commands of its scenes."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def gallery() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_gallery", ROOT / "scripts" / "tools" / "make_gallery.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_is_that_of_the_scenes(gallery: ModuleType) -> None:
    scenes = [scene for scene in yaml.safe_load(gallery.SCENES.read_text()) if gallery.video_of(scene).is_file()]
    assert gallery.page(scenes) == gallery.PAGE.read_text()


def test_a_way_is_filmed_from_its_states(gallery: ModuleType) -> None:
    way = {
        "name": "held",
        "way": "ways/a",
        "held": 4,
        "every": 2,
        "task": "ARC-Cecum-Magnetic",
        "overrides": ["env.seed=1"],
    }
    words = gallery.command(way, "cpu")[1:]
    assert words == [
        "scripts/tools/film_way.py", "ways/a", "held.mp4", "--every", "2", "--held", "4",
        "--task", "ARC-Cecum-Magnetic", "env.seed=1",
    ]  # fmt: skip
