# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Effects of a living colon and a used scope, switched on by name: ``env.clinical=[all]``, or some of them."""

from __future__ import annotations

from typing import Any

from arcgym.utils.validation import FieldError

ALL = "all"
"""Name for every effect."""
EFFECTS = ("tissue", "relaxation", "gas", "weight", "scope", "friction", "abdomen", "mesentery")
"""Names of the effects."""

STIFFENING = 1.5
"""Factor of stiffening that goes with the modulus of the tissue ``clinical``."""
PASSIVE_LENGTH, DISTAL_LENGTH = 0.1, 0.3
"""Lengths of the scope's passive section and softer distal part [m]; choices, see ``GradingCfg``."""
PLAY, LAG = 0.26, 0.05
"""Play of the wheels [rad] and lag of the bending section [s]; choices, see ``BendingDriveCfg``."""
FRICTION, STATIC_FRICTION = 0.12, 1.4
"""Friction on human mucosa (Watanabe 2024), and that at rest over it (a choice)."""


def chosen(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the effects that some names stand for."""
    return EFFECTS if ALL in names else tuple(names)


def check(cfg: Any) -> None:
    """Check that a navigation task can have the effects that ``cfg.clinical`` names.

    Raises:
        FieldError: If a wall of tetrahedra or another solver has none of them.
    """
    on = set(chosen(cfg.clinical))
    if on & {"tissue", "relaxation", "gas", "abdomen"} and cfg.scene.colon.wall_model != "shell":
        raise FieldError(
            cfg, "clinical", f"is {list(cfg.clinical)}, which needs env.scene.colon.wall_model=shell; it is 'solid'."
        )
    if on - {"scope"} and cfg.sim.solver != "two_level":
        raise FieldError(cfg, "clinical", f"is {list(cfg.clinical)}, which needs env.sim.solver=two_level.")


def make_clinical(cfg: Any) -> None:
    """Switch on what ``cfg.clinical`` names; done again, it changes nothing more.

    Numbers that are not as shipped stay as they were given.

    Args:
        cfg: :class:`arcgym_tasks.navigation.navigation_env_cfg.NavigationEnvCfg`.
    """
    for name in chosen(cfg.clinical):
        _SWITCHES[name](cfg)


def _tissue(cfg: Any) -> None:
    colon = cfg.scene.colon
    colon.wall_law.thickness_by_diameter = True
    if colon.material == "paper":
        colon.material = "clinical"
        _where_default(colon.wall_law, "stiffening", None, STIFFENING)


def _relaxation(cfg: Any) -> None:
    cfg.scene.colon.wall_law.relaxation = True


def _gas(cfg: Any) -> None:
    _where_default(cfg, "gas", "none", "present")


def _weight(cfg: Any) -> None:
    cfg.sim.weight.enabled = True


def _scope(cfg: Any) -> None:
    """Grade the shaft and loosen the wheels of a scope that has them."""
    scope = cfg.scene.endoscope
    drive = scope.actuators.get("bending")
    if drive is None:
        return
    _where_default(scope.grading, "passive_length", 0.0, PASSIVE_LENGTH)
    _where_default(scope.grading, "distal_length", 0.0, DISTAL_LENGTH)
    _where_default(drive, "play", 0.0, PLAY)
    _where_default(drive, "lag", 0.0, LAG)


def _friction(cfg: Any) -> None:
    _where_default(cfg.sim.contact, "friction", type(cfg.sim.contact)().friction, FRICTION)
    _where_default(cfg.sim.contact, "static_friction", 1.0, STATIC_FRICTION)


def _abdomen(cfg: Any) -> None:
    cfg.scene.colon.abdomen.enabled = True


def _mesentery(cfg: Any) -> None:
    cfg.scene.colon.mesentery.enabled = True


def _where_default(cfg: Any, name: str, shipped: Any, value: Any) -> None:
    if getattr(cfg, name) == shipped:
        setattr(cfg, name, value)


_SWITCHES = {
    "tissue": _tissue,
    "relaxation": _relaxation,
    "gas": _gas,
    "weight": _weight,
    "scope": _scope,
    "friction": _friction,
    "abdomen": _abdomen,
    "mesentery": _mesentery,
}
