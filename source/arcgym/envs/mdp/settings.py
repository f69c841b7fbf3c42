# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Settings that a task makes once and its terms share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


def task_setting(env: ManagerBasedEnv, name: str, value: Any = None) -> Any:
    """Return a term's own parameter, or the task's field of that name where the parameter is None.

    Args:
        env: The environment.
        name: Name of the parameter and of the field of ``env.cfg``, such as ``segment``.
        value: The term's parameter.

    Raises:
        ValueError: If neither the term nor the task has a value.
    """
    if value is not None:
        return value
    if getattr(env.cfg, name, None) is None:
        raise ValueError(
            f"A term needs '{name}', but {type(env.cfg).__name__} has no such field. "
            f'Add the field, or give the term params={{"{name}": ...}}.'
        )
    return getattr(env.cfg, name)
