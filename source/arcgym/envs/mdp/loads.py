# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Loads on the wall: terms ``(env, **params) -> (N,)`` that serve rewards, costs, terminations and metrics alike.

Forces are those on the tip, its most distal 20 mm, and on windows of 50 mm along the whole scope
(:mod:`arcgym.assets.force_windows`), which do not depend on the links. A load is a mean over the control step, or its
peak, the largest of its physics steps. By one rule for all of them:
:func:`load` is its value, :func:`load_above` whether it exceeds a limit, :func:`load_excess` by how much.

Add a load of your own with ``mdp.LOADS["pressure"] = mdp.Load("colon", "pressure", "pressure_peak", "Pa")``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import torch

from arcgym.assets.force_tiers import FORCE_TIERS, ForceTiersCfg, tier_limit, tiers_of
from arcgym.utils.validation import expects

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

__all__ = [
    "FORCE_TIERS",
    "LOADS",
    "ForceTiersCfg",
    "Load",
    "force_limit",
    "load",
    "load_above",
    "load_excess",
    "load_l2",
    "load_parts",
]


@dataclass(frozen=True)
class Load:
    """Where a load is read."""

    entity: str
    """Element of the scene."""

    mean: str
    """Attribute of its data: mean over the control step, shape (N,) or (N, P) for P parts."""

    peak: str
    """Attribute of its data: largest in a physics step of the control step, of the same shape."""

    unit: str
    """Unit of the load; empty for a ratio."""

    scale: float = 1.0
    """A usual value: percentiles tell values from a hundredth of it to a hundred times apart. Set it for a load that is
    mostly larger or smaller."""


LOADS = {
    "tip_force": Load("endoscope", "tip_force", "tip_force_peak", "N"),
    "shaft_force": Load("endoscope", "window_force_norm", "window_force_peak", "N"),
    "wall_strain": Load("colon", "wall_strain", "wall_strain_peak", "", 0.1),
    "anchor_tension": Load("colon", "anchor_tension", "anchor_tension_peak", "N"),
    "lumen_pressure": Load("colon", "lumen_pressure_mean", "lumen_pressure_peak", "Pa", 1000.0),
}
"""Loads by kind: force between tip and wall, between each window of the scope and wall (the tip's windows included),
largest principal strain of each ring of the wall, pull of each ring on its anchors (the mesentery), pressure of the gas
in the lumen where there is gas."""

REDUCTIONS = ("mean", "peak")
"""How a load is reduced over the physics steps of a control step."""

TIERS = tuple(vars(FORCE_TIERS))
"""Names of the tiers that a limit of force may be given by."""


@expects(kind=LOADS, reduce=REDUCTIONS)
def load_parts(env: ManagerBasedEnv, kind: str, reduce: str = "mean") -> torch.Tensor:
    """Load on each part, a window of the scope or a ring of the wall [N, or strain], shape (N, P).

    The windows of a scope are as many as its length has, 67 for the shipped colonoscopes and 1 for the capsule.

    Args:
        kind: One of :data:`LOADS`. ``tip_force`` has one part.
        reduce: ``mean`` over the control step, or ``peak`` of its physics steps.
    """
    source = LOADS[kind]
    value = getattr(env.scene[source.entity].data, source.peak if reduce == "peak" else source.mean)
    return value.unsqueeze(1) if value.dim() == 1 else value


@expects(kind=LOADS, reduce=REDUCTIONS)
def load(env: ManagerBasedEnv, kind: str, reduce: str = "mean") -> torch.Tensor:
    """Largest load on a part, a window of the scope or a ring of the wall [N, or strain], shape (N,).

    It may be memory that the next step overwrites.

    Args:
        kind: One of :data:`LOADS`.
        reduce: ``mean`` over the control step, or ``peak`` of its physics steps.
    """
    parts = load_parts(env, kind, reduce)
    return parts.squeeze(1) if parts.shape[1] == 1 else parts.amax(dim=1)


@expects(kind=LOADS, reduce=REDUCTIONS, limit=TIERS)
def load_above(env: ManagerBasedEnv, kind: str, limit: float | str, reduce: str = "mean") -> torch.Tensor:
    """Whether some part bears more than a limit, bool, shape (N,).

    Colon perforated at 14.1 N under a straight tip (tier ``perforation``) and tore at strains near 1.8 (Egorov et al.
    2002, transverse strips); no safe strain or pull in vivo is published. The perforation limit was measured in slow
    pushes: a ``peak`` of 4 ms is contact noise as well.

    Args:
        kind: One of :data:`LOADS`.
        limit: Limit [N, or strain], or the name of a tier of force.
        reduce: ``mean`` over the control step, or ``peak`` of its physics steps.
    """
    return load(env, kind, reduce) > force_limit(env, limit, kind)


@expects(kind=LOADS, reduce=REDUCTIONS, limit=TIERS)
def load_excess(env: ManagerBasedEnv, kind: str, limit: float | str, reduce: str = "mean") -> torch.Tensor:
    """Amount by which the largest load exceeds a limit, else 0 [N, or strain], shape (N,).

    Args:
        kind: One of :data:`LOADS`.
        limit: Limit [N, or strain], or the name of a tier of force.
        reduce: ``mean`` over the control step, or ``peak`` of its physics steps.
    """
    return (load(env, kind, reduce) - force_limit(env, limit, kind)).clamp(min=0.0)


@expects(kind=LOADS, reduce=REDUCTIONS)
def load_l2(env: ManagerBasedEnv, kind: str, reduce: str = "mean") -> torch.Tensor:
    """Square of the largest load [N^2, or strain^2], shape (N,).

    Args:
        kind: One of :data:`LOADS`.
        reduce: ``mean`` over the control step, or ``peak`` of its physics steps.
    """
    return load(env, kind, reduce).square()


def force_limit(env: ManagerBasedEnv, limit: float | str, kind: str = "tip_force") -> float:
    """Return a limit, given as a number or as the name of a tier of the task [N].

    Args:
        env: Environment.
        limit: A number, or the name of a tier of force.
        kind: One of :data:`LOADS`, of which it is the limit.

    Raises:
        ValueError: If there is no such tier, with those there are, or the load is no force.
    """
    if isinstance(limit, str) and LOADS[kind].unit != "N":
        raise ValueError(f"limit is '{limit}' for {kind}, expected a number: tiers are of forces.")
    return tier_limit(tiers_of(env.cfg), limit)
