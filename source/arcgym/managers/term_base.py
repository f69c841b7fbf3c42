# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Base of terms that are classes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


class ManagerTermBase:
    """A term with memory: constructed once, called like a function, reset with the worlds."""

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Keep configuration and environment.

        Args:
            cfg: Configuration of the term, its scene entities resolved.
            env: Environment the term belongs to.
        """
        self.cfg = cfg
        self._env = env

    @property
    def num_envs(self) -> int:
        """Number of worlds N."""
        return self._env.num_envs

    @property
    def device(self) -> str:
        """Device of all tensors."""
        return self._env.device

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget the past of some worlds; called at each reset.

        Args:
            env_ids: World indices, int64, shape (n,); None for all.
        """

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Evaluate the term: ``(env, **params)``, or ``(env, env_ids, **params)`` for events and curricula."""
        raise NotImplementedError(f"{type(self).__name__} does not define __call__.")
