# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Effects of a living colon and a used scope, switched on by name: ``env.clinical=[all]``, or some of them."""

from __future__ import annotations

from typing import Any

from arcgym.envs import mdp
from arcgym.managers import EventTermCfg
from arcgym.utils.validation import FieldError

PHYSICS = ("tissue", "relaxation", "gas", "tension", "weight", "scope", "friction", "abdomen", "mesentery", "loops")
"""Effects on what is simulated."""
CAMERA = ("latency", "exposure", "light", "preparation")
"""Effects on what the camera sees."""
EFFECTS = (*PHYSICS, *CAMERA)
"""Names of the effects."""
GROUPS = {"all": EFFECTS, "camera": CAMERA}
"""Names that stand for several effects."""

STIFFENING = 1.5
"""Factor of stiffening that goes with the modulus of the tissue ``clinical``."""
CONTACT_SHARE = 3.5
"""Share of that tissue's stiffness that a contact has: 658 N/m, as ``in_situ``. The modulus is one along a wall that is
stretched already, and a patch of pig's colon gives by 0.7 to 0.8 N/mm under a tip; with the share of other tissues, 125
N/m, a tip went through the wall at 10 N, where human colon bears 14 to 46 N."""
PASSIVE_LENGTH, DISTAL_LENGTH = 0.1, 0.3
"""Lengths of the scope's passive section and softer distal part [m]; choices, see ``GradingCfg``."""
PLAY, LAG = 0.26, 0.05
"""Play of the wheels [rad] and lag of the bending section [s]; choices, see ``BendingDriveCfg``."""
FRICTION, STATIC_FRICTION = 0.12, 1.4
"""Friction on human mucosa (Watanabe 2024), and that at rest over it (a choice)."""
LATENCY = 0.08
"""Age of a picture when it is seen [s]; of robots' video chains 62 ms were measured, and 147 through a computer."""
SHUTTER, EXPOSURE_LAG = (1.0 / 200.0, 1.0 / 60.0), 0.6
"""Shortest and longest exposure [s] of a picture at 50 to 60 Hz, and share of the last gain that is kept in 0.1 s;
choices."""
CONCENTRATION, GAMMA = 2.77, 2.2
"""Fall-off of a colonoscope's light with the angle, and its camera's gamma (EndoMapper's calibration of one scope)."""
LAMP = (0.0011, 0.0, 0.0036)
"""Middle of that light, 1.1 mm beside and 3.6 mm behind the camera's center, in the camera's frame [m]; to which side
is a choice."""
SCORES = (2, 3, 3)
"""Boston bowel preparation scores where none are drawn: right, transverse and left colon; a choice."""


def chosen(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the effects that some names stand for."""
    meant = {effect for name in names for effect in GROUPS.get(name, (name,))}
    return tuple(effect for effect in EFFECTS if effect in meant)


def check(cfg: Any) -> None:
    """Check that a navigation task can have the effects that ``cfg.clinical`` names.

    Raises:
        FieldError: If a wall of tetrahedra or another solver has none of them.
    """
    on = set(chosen(cfg.clinical))
    if on & {"tissue", "relaxation", "gas", "tension", "abdomen"} and cfg.scene.colon.wall_model != "shell":
        raise FieldError(
            cfg, "clinical", f"is {list(cfg.clinical)}, which needs env.scene.colon.wall_model=shell; it is 'solid'."
        )
    if on & set(PHYSICS) - {"scope"} and cfg.sim.solver != "two_level":
        raise FieldError(cfg, "clinical", f"is {list(cfg.clinical)}, which needs env.sim.solver=two_level.")


def make_clinical(cfg: Any) -> None:
    """Switch on what ``cfg.clinical`` names; done again, it changes nothing more.

    Numbers that are not as shipped stay as they were given. Groups become the names that they stand for, so that what
    was recorded with ``all`` is replayed without effects that came later.

    Args:
        cfg: :class:`arcgym_tasks.navigation.navigation_env_cfg.NavigationEnvCfg`.
    """
    cfg.clinical = chosen(cfg.clinical)
    for name in cfg.clinical:
        if name not in CAMERA or getattr(cfg.scene, "camera", None) is not None:
            _SWITCHES[name](cfg)


def _tissue(cfg: Any) -> None:
    colon = cfg.scene.colon
    colon.wall_law.thickness_by_diameter = True
    if colon.material == "paper":
        colon.material = "clinical"
        _where_default(colon.wall_law, "stiffening", None, STIFFENING)
        _where_default(cfg.sim.contact, "tissue_share", type(cfg.sim.contact)().tissue_share, CONTACT_SHARE)


def _relaxation(cfg: Any) -> None:
    cfg.scene.colon.wall_law.relaxation = True


def _gas(cfg: Any) -> None:
    _where_default(cfg, "gas", "none", "present")


def _tension(cfg: Any) -> None:
    """Keep the tension that bears the gas, which is then there, too."""
    _gas(cfg)
    cfg.scene.colon.gas.pretension = True


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


def _loops(cfg: Any) -> None:
    cfg.sim.loops.enabled = True


def _latency(cfg: Any) -> None:
    _where_default(cfg.scene.camera, "latency", 0.0, LATENCY)


def _exposure(cfg: Any) -> None:
    exposure = cfg.scene.camera.exposure
    _where_default(exposure, "shutter", None, SHUTTER)
    _where_default(exposure, "lag", 0.0, EXPOSURE_LAG)


def _light(cfg: Any) -> None:
    """Take a measured light and camera response, in which vignette and contrast are contained already."""
    lighting, exposure = cfg.scene.camera.lighting, cfg.scene.camera.exposure
    _where_default(lighting, "concentration", None, CONCENTRATION)
    _where_default(lighting, "lamp", None, LAMP)
    for name, value in {"gamma": GAMMA, "vignette": 0.0, "contrast": 0.0}.items():
        _where_default(exposure, name, getattr(type(exposure)(), name), value)


def _preparation(cfg: Any) -> None:
    _where_default(cfg.scene.camera.preparation, "scores", None, SCORES)
    if cfg.events is not None:  # a replay has none
        _where_default(cfg.events, "preparation", None, EventTermCfg(func=mdp.randomize_preparation, mode="reset"))


def _where_default(cfg: Any, name: str, shipped: Any, value: Any) -> None:
    if getattr(cfg, name) == shipped:
        setattr(cfg, name, value)


_SWITCHES = {
    "tissue": _tissue,
    "relaxation": _relaxation,
    "gas": _gas,
    "tension": _tension,
    "weight": _weight,
    "scope": _scope,
    "friction": _friction,
    "abdomen": _abdomen,
    "mesentery": _mesentery,
    "loops": _loops,
    "latency": _latency,
    "exposure": _exposure,
    "light": _light,
    "preparation": _preparation,
}
