# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Curriculum terms ``(env, env_ids, **params) -> float``, called at resets; the returned value is logged."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv


def widen_reset(
    env: ManagerBasedRLEnv,
    env_ids: torch.Tensor,
    event: str,
    param: str,
    start: float,
    end: float,
    num_steps: int,
) -> float:
    """Move a parameter of a reset event linearly from ``start`` to ``end`` over the first ``num_steps`` control steps.

    Example: begin with the scope aimed at the lumen and widen the perturbation of its start while the policy learns.

    Args:
        env: The environment.
        env_ids: Worlds that are reset; the parameter is the same for all.
        event: Name of the event term.
        param: Name of its parameter.
        start: Value at step zero.
        end: Value from ``num_steps`` on.
        num_steps: Control steps, counted by ``env.common_step_counter``.

    Returns:
        The value now in use.
    """
    fraction = min(env.common_step_counter / num_steps, 1.0)
    value = start + (end - start) * fraction
    env.event_manager.get_term_cfg(event).params[param] = value
    return value
