# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Which navigation tasks may go back where a tether no longer comes on."""

from __future__ import annotations

from typing import Any

from arcgym.assets.endoscope_reader import read_endoscope
from arcgym.utils.paths import resolve_asset
from arcgym.utils.validation import FieldError


def check_back_off(cfg: Any) -> None:
    """Check that an action with ``back_off_velocity`` has a tether to read, which is to come on.

    Args:
        cfg: :class:`arcgym_tasks.navigation.navigation_env_cfg.NavigationEnvCfg`.

    Raises:
        FieldError: If the scope has no length inside, or is on its way out.
    """
    terms = cfg.actions if isinstance(cfg.actions, dict) else vars(cfg.actions)
    for name, term in terms.items():
        speed = getattr(term, "back_off_velocity", 0.0)
        if speed > 0.0 and (reason := _obstacle(cfg)):
            text = f"is {speed:g} m/s, but {reason}: set it to 0, or take a task such as ARC-LeftColon-Magnetic."
            raise FieldError(cfg, f"actions.{name}.back_off_velocity", text)


def _obstacle(cfg: Any) -> str:
    """Return why a task cannot have it, and nothing if it can."""
    if cfg.direction == "withdrawal":
        return "on its way out no scope comes on"
    stage = resolve_asset(cfg.scene.endoscope.usd_path)
    tethered = read_endoscope(stage).root == "slide_roll"
    return "" if tethered else f"{stage.name} has no tether whose length it could read"
