# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""An assistant's hand on the abdomen of a navigation task: ``env.hand_pressure=commanded``."""

from __future__ import annotations

from typing import Any

from arcgym.envs import mdp
from arcgym.utils.validation import FieldError, require

NONE, COMMANDED = "none", "commanded"
"""Values of ``env.hand_pressure``: no hand on the abdomen, one that an action moves."""


def check_hand(cfg: Any) -> None:
    """Check that a navigation task can have the hand that ``cfg.hand_pressure`` asks for.

    Raises:
        FieldError: If the name is unknown, or there can be no abdomen to press on.
    """
    require(cfg, "hand_pressure", (NONE, COMMANDED))
    if cfg.hand_pressure == NONE:
        return
    for owner, name, needed in ((cfg.scene.colon, "wall_model", "shell"), (cfg.sim, "solver", "two_level")):
        if getattr(owner, name) != needed:
            path = "scene.colon.wall_model" if name == "wall_model" else "sim.solver"
            raise FieldError(cfg, "hand_pressure", f"is '{cfg.hand_pressure}', which needs env.{path}={needed}.")


def add_hand(cfg: Any) -> None:
    """Put the abdomen around the colon and add the action, if ``cfg.hand_pressure`` asks for it.

    An action that was given stands; done again, it changes nothing more.

    Args:
        cfg: :class:`arcgym_tasks.navigation.navigation_env_cfg.NavigationEnvCfg`.
    """
    if cfg.hand_pressure == NONE:
        return
    cfg.scene.colon.abdomen.enabled = True
    if getattr(cfg.actions, "hand", None) is None:
        cfg.actions.hand = mdp.HandPressureActionCfg()
