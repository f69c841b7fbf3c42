# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Curriculum terms ``(env, env_ids, **params) -> float``, called at resets; the returned value is logged."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.utils.validation import Range, expects

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

__all__ = ["move_param"]


MANAGERS = ("event", "reward", "cost", "termination")
"""Kinds of terms whose parameters :func:`move_param` moves."""


@expects(manager=MANAGERS, num_steps=Range(1))
def move_param(
    env: ManagerBasedRLEnv,
    env_ids: torch.Tensor,
    manager: str,
    term: str,
    param: str,
    start: float,
    end: float,
    num_steps: int,
) -> float:
    """Move a parameter of a term linearly from one value to another, in all worlds alike; its value is logged.

    Examples: begin with the scope aimed at the lumen and widen the perturbation of its start while the policy learns;
    lower the limit of a force from the unsafe to the comfortable.

    Args:
        manager: One of :data:`MANAGERS`.
        term: Name of the term.
        param: Name of its parameter, a number.
        start: Value at step zero.
        end: Value from ``num_steps`` on.
        num_steps: Control steps, counted by ``env.common_step_counter``.

    Returns:
        The value now in use.
    """
    fraction = min(env.common_step_counter / num_steps, 1.0)
    value = start + (end - start) * fraction
    getattr(env, f"{manager}_manager").get_term_cfg(term).params[param] = value
    return value
