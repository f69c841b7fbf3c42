# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Scenes: what is in the worlds."""

import importlib
from typing import TYPE_CHECKING, Any

from arcgym.scene.interactive_scene_cfg import InteractiveSceneCfg

if TYPE_CHECKING:
    from arcgym.scene.interactive_scene import InteractiveScene

__all__ = ["InteractiveScene", "InteractiveSceneCfg"]


def __getattr__(name: str) -> Any:
    """Import torch and Newton only when the runtime class is asked for."""
    if name == "InteractiveScene":
        return importlib.import_module("arcgym.scene.interactive_scene").InteractiveScene
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
