# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Fields of an environment that are the agent's to choose; all others make a task what it is."""

from __future__ import annotations

from typing import Any

AGENTS_OWN = (
    *("observations", "extra_observations", "reward", "rewards", "costs", "viewer"),
    *("is_finite_horizon", "scale_rewards_by_dt", "compute_final_obs"),
    *("actions.tip.roll_period", "actions.base.roll_period"),
    *("actions.tip.back_off_after", "actions.tip.back_off_time"),
)
"""Fields of the environment, with all below them, that are the agent's: all others make a task what it is."""

CONTACT_ROOM = ("sim.contact.capacity", "sim.contact.patch_capacity")
"""Fields of the environment that give contacts room, and change nothing where they had enough."""

AGENT_LIMITS = {
    "actions.tip.forward_velocity": 0.045,
    "actions.capsule.forward_velocity": 0.05,
    "actions.base.insertion_velocity": 0.05,
    "actions.tip.roll_amplitude": 18.0,
    "actions.base.roll_amplitude": 9.0,
    "actions.tip.back_off_velocity": 0.045,
    "actions.tip.linear_scale": 0.045,
    "actions.capsule.linear_scale": 0.05,
    "actions.base.insertion_scale": 0.05,
}
"""Fields that are the agent's up to a value. A constant velocity: the largest that actions command [m/s]. A smaller
scale of velocities than the task's: a policy that is slow might have been so by smaller actions [m/s]. A roll to and
fro: the largest amplitude that scripted experts draw, who are not the task's either (``roll`` of
:class:`arcgym.experts.PullExpert` for a tip, ``twist`` of :class:`arcgym.experts.PushExpert` for a base) [rad/s]. Going
back where a tether no longer comes on: the largest velocity that actions command [m/s]."""

VELOCITIES = tuple(path for path in AGENT_LIMITS if path.endswith((".forward_velocity", ".insertion_velocity")))
"""Fields of :data:`AGENT_LIMITS` that set a constant velocity; tables name their values."""

BACK_OFFS = tuple(path for path in AGENT_LIMITS if path.endswith(".back_off_velocity"))
"""Fields of :data:`AGENT_LIMITS` that set how fast a tip goes back when its tether is stuck; tables name their values.
"""

ROLLS = tuple(path for path in AGENT_LIMITS if path.endswith(".roll_amplitude"))
"""Fields of :data:`AGENT_LIMITS` that set a roll to and fro; tables name their values."""

SCALES = tuple(path for path in AGENT_LIMITS if path.endswith("_scale"))
"""Fields of :data:`AGENT_LIMITS` that scale the velocities that actions command; tables name their values."""


def is_agents(path: str, used: Any) -> bool:
    """Return whether a field of the environment, by its path, is the agent's to choose, with the value used.

    So is the room for contacts.
    """
    if path in AGENT_LIMITS:
        return used is None or (isinstance(used, int | float) and abs(used) <= AGENT_LIMITS[path])
    return path in CONTACT_ROOM or any(path == own or path.startswith(f"{own}.") for own in AGENTS_OWN)
