# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Gas in the lumen of a navigation task: ``env.gas=present``, or ``commanded``."""

from __future__ import annotations

from typing import Any

from arcgym.envs import mdp
from arcgym.managers import CostTermCfg as CostTerm
from arcgym.managers import MetricsTermCfg as MetricsTerm
from arcgym.utils.validation import FieldError, require

NONE, PRESENT, COMMANDED = "none", "present", "commanded"
"""Values of ``env.gas``: no gas, gas without an action, gas that an action insufflates and sucks off."""


def check_gas(cfg: Any) -> None:
    """Check that a navigation task can have the gas that ``cfg.gas`` asks for.

    Raises:
        FieldError: If the name is unknown, or the wall is of tetrahedra.
    """
    require(cfg, "gas", (NONE, PRESENT, COMMANDED))
    if cfg.gas != NONE and cfg.scene.colon.wall_model != "shell":
        raise FieldError(cfg, "gas", f"is '{cfg.gas}', which needs env.scene.colon.wall_model=shell.")


def add_gas(cfg: Any) -> None:
    """Simulate the gas that ``cfg.gas`` asks for, with what measures it and, if it is commanded, its action.

    Terms that were given stand; done again, it changes nothing more.

    Args:
        cfg: :class:`arcgym_tasks.navigation.navigation_env_cfg.NavigationEnvCfg`.
    """
    if cfg.gas == NONE:
        return
    cfg.scene.colon.gas.enabled = True
    pressure = {"kind": "lumen_pressure"}
    rupture = CostTerm(func=mdp.load_above, params={**pressure, "limit": mdp.RUPTURE_PRESSURE})
    mean = MetricsTerm(func=mdp.load, reduce="mean", params=pressure)
    peak = MetricsTerm(func=mdp.load, reduce="max", params={**pressure, "reduce": "peak"})
    terms: list[tuple[Any, str, Any]] = [(cfg.costs, "lumen_pressure", rupture)]
    terms += [(cfg.metrics, "mean_lumen_pressure", mean), (cfg.metrics, "max_lumen_pressure", peak)]
    if cfg.gas == COMMANDED:
        terms.append((cfg.actions, "gas", mdp.GasFlowActionCfg()))
    for owner, name, term in terms:
        if owner is not None and getattr(owner, name, None) is None:
            setattr(owner, name, term)
