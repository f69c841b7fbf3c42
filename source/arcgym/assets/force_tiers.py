# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Tiers of contact force: one place for the limits that terms, metrics and pictures share."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym.utils.string import did_you_mean
from arcgym.utils.validation import require_order, require_positive


@configclass
class ForceTiersCfg:
    """Limits of the force between scope and wall [N], ascending.

    A task that has a field ``force_tiers`` of this type changes them for all its terms and for its pictures.
    """

    comfort: float = 2.0
    """End of the comfortable tier. A choice of this benchmark: no clinical threshold of pain in newtons is published.
    Lower it to train gentler policies."""

    unsafe: float = 5.0
    """Start of the unsafe tier. A choice of this benchmark: about a third of the perforation force."""

    perforation: float = 14.1
    """Start of the tier in which the wall may tear. A straight, large colonoscope head loaded at an angle perforated
    porcine colon at 14.1 N, one bent by 90 degrees at 46.5 N (Johnson et al. 2019, J. Mech. Behav. Biomed. Mater. 91,
    139-148). Diseased or thinned walls may tear earlier."""

    def validate_config(self) -> None:
        """Check the order.

        Raises:
            ValueError: If the limits do not rise from a positive one.
        """
        require_positive(self, "comfort", "unsafe", "perforation", unit="N")
        require_order(self, "comfort", "unsafe", "perforation", unit="N")


FORCE_TIERS = ForceTiersCfg()
"""Tiers of tasks that define none."""


def tiers_of(env_cfg: object) -> ForceTiersCfg:
    """Return the tiers of a task: its field ``force_tiers``, or the defaults where it has none.

    Args:
        env_cfg: The task's configuration, ``env.cfg``.
    """
    return getattr(env_cfg, "force_tiers", None) or FORCE_TIERS


def tier_limit(tiers: ForceTiersCfg, limit: float | str) -> float:
    """Return a limit of force [N].

    Args:
        tiers: The task's tiers.
        limit: A number [N], or the name of a tier: ``comfort``, ``unsafe`` or ``perforation``.

    Raises:
        ValueError: If there is no such tier, with those there are.
    """
    if not isinstance(limit, str):
        return limit
    if limit not in vars(tiers):
        raise ValueError(f"There is no force tier '{limit}'. {did_you_mean(limit, vars(tiers))}")
    return getattr(tiers, limit)
