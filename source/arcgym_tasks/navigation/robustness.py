# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Variants of a task that ask what a policy stands, ``env.robustness=blur_2``: a kind and one of three strengths."""

from __future__ import annotations

from typing import Any

from arcgym.envs import mdp
from arcgym.managers import EventTermCfg, ObservationTermCfg
from arcgym.utils.string import resolve_callable

NONE = "none"
"""The task as it is."""

PICTURES: dict[str, tuple[float, float, float]] = {
    "fluid": (8.0, 16.0, 32.0),
    "stool": (0.2, 0.5, 1.0),
    "bubbles": (0.2, 0.5, 1.0),
    "blur": (0.01, 0.02, 0.04),
    "droplets": (3.0, 6.0, 12.0),
    "noise": (5.0, 12.0, 25.0),
    "dropped": (0.1, 0.3, 0.5),
}
"""Amounts of what spoils the policy's picture, see :data:`arcgym.envs.mdp.IMAGE_FAULTS`."""

LIGHTS: dict[str, tuple[float, float, float]] = {"dim": (0.5, 0.25, 0.1), "blown": (2.0, 4.0, 8.0)}
"""Factors on the brightness that the exposure aims at."""

DELAYS: dict[str, tuple[int, int, int]] = {"delay": (1, 2, 4)}
"""Age of the policy's pictures, at least [control steps of 0.1 s]."""

BODIES: dict[str, tuple[float, float, float]] = {
    "soft": (0.5, 0.25, 0.1),
    "sticky": (2.0, 3.0, 5.0),
    "collapsed": (0.9, 0.8, 0.7),
}
"""``soft``: factors on Young's modulus of the wall. ``sticky``: factors on the friction between scope and wall.
``collapsed``: factors on the width of the lumen, as with less gas, in patients of the population, who are made anew."""

KINDS: dict[str, tuple[Any, Any, Any]] = {**PICTURES, **LIGHTS, **DELAYS, **BODIES}
"""Amounts of the three strengths by kind. All of them are our choices."""

VARIANTS = tuple(f"{kind}_{strength}" for kind in KINDS for strength in (1, 2, 3))
"""Names of all variants."""


def make_harder(cfg: Any, variant: str) -> None:
    """Change a navigation task's configuration into a variant; done again, it changes nothing more.

    Args:
        cfg: :class:`arcgym_tasks.navigation.navigation_env_cfg.NavigationEnvCfg`.
        variant: One of :data:`VARIANTS`, or ``none``.

    Raises:
        ValueError: If the task lacks what the variant changes.
    """
    if variant == NONE:
        return
    kind, _, strength = variant.rpartition("_")
    amount = KINDS[kind][int(strength) - 1]
    if kind in PICTURES:
        for rgb in _policy_pictures(cfg, variant):
            rgb.func, rgb.params = mdp.impaired_rgb, {**rgb.params, "kind": kind, "amount": amount}
    elif kind in DELAYS:
        for rgb in _policy_pictures(cfg, variant):
            rgb.delay_min_lag, rgb.delay_max_lag = max(rgb.delay_min_lag, amount), max(rgb.delay_max_lag, amount)
    elif kind in LIGHTS:
        _multiply(cfg, "light", mdp.randomize_light, "gain", amount, 1.0)
    elif kind == "soft":
        _multiply(cfg, "stiffness", mdp.randomize_tissue_stiffness, "scale", amount, 1.0)
    elif kind == "sticky":
        _multiply(cfg, "friction", mdp.randomize_friction, "friction", amount, cfg.sim.contact.friction)
    elif kind == "collapsed":
        cfg.scene.colon.usd_path = _narrower(cfg.scene.colon.usd_path, amount)


def _policy_pictures(cfg: Any, variant: str) -> list[Any]:
    """Return the terms of the policy's pictures, those that were added to its group as well."""
    group = cfg.observations.policy
    terms = [*vars(group).values(), *group.terms.values()]
    found = [term for term in terms if isinstance(term, ObservationTermCfg) and _is_picture(term.func)]
    if not found:
        raise ValueError(
            f"env.robustness={variant} changes the pictures of env.observations.policy, which has none in this task."
        )
    return found


def _is_picture(func: Any) -> bool:
    return (resolve_callable(func) if isinstance(func, str) else func) in (mdp.rgb, mdp.impaired_rgb)


def _multiply(cfg: Any, name: str, func: Any, param: str, factor: float, neutral: float) -> None:
    """Multiply what an event draws; where the event is off, it gives one value."""
    event = getattr(cfg.events, name, None)
    if event is None:
        event = EventTermCfg(func=func, mode="reset", params={param: (neutral, neutral)})
        setattr(cfg.events, name, event)
    event.params = {**event.params, "factor": factor}


def _with_gas(patient: str, factor: float) -> str:
    """Return the name of a patient, ``20000`` or ``20000*0.9``, with another factor on its width."""
    return f"{patient.partition('*')[0]}*{factor:g}"


def _narrower(usd_path: str | list[str], factor: float) -> str | list[str]:
    """Return the names of the same patients of the population with less gas.

    Raises:
        ValueError: If some patient is not of the population.
    """
    names = [usd_path] if isinstance(usd_path, str) else list(usd_path)
    for name in names:
        if not name.startswith("population:"):
            raise ValueError(
                f"env.robustness=collapsed_... makes patients of the population anew with less gas; {name} is a stage. "
                "Choose env.scene.colon.usd_path=population:20000, or leave the variant out."
            )
    patients = [name.removeprefix("population:").split(",") for name in names]
    changed = ["population:" + ",".join(_with_gas(patient, factor) for patient in own) for own in patients]
    return changed[0] if isinstance(usd_path, str) else changed
