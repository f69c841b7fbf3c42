# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Scenes: what is in the worlds."""

from typing import TYPE_CHECKING

from arcgym.scene.interactive_scene_cfg import InteractiveSceneCfg
from arcgym.utils.lazy import lazy_names

if TYPE_CHECKING:
    from arcgym.scene.interactive_scene import InteractiveScene

__all__ = ["InteractiveScene", "InteractiveSceneCfg"]

__getattr__ = lazy_names(__name__, {"InteractiveScene": "arcgym.scene.interactive_scene"})
