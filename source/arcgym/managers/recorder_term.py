# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Base of what can be recorded."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv
    from arcgym.managers.recorder_cfg import RecorderTermCfg

Record = tuple[str | None, torch.Tensor | dict[str, Any] | None]
"""Name and value, or (None, None) for nothing. A dict, which may be nested, records ``name/key`` for each entry."""


class RecorderTerm:
    """Answers at some points of a step with what to record there; the others stay as they are here.

    A value recorded in a step has shape (N, ...) and must come in every step; one recorded at a reset has shape
    (n, ...), an entry for each of the reset worlds, and is stored once an episode. Values are copied at once.
    """

    def __init__(self, cfg: RecorderTermCfg, env: ManagerBasedEnv) -> None:
        """Keep configuration and environment."""
        self.cfg = cfg
        self._env = env

    def record_pre_step(self) -> Record:
        """Return a record when the action is known and nothing has moved yet; ``env.obs_buf`` is what led to it."""
        return None, None

    def record_post_step(self) -> Record:
        """Return a record when rewards and terminations are known and no world has been reset yet."""
        return None, None

    def record_pre_reset(self, env_ids: torch.Tensor) -> Record:
        """Return a record of the worlds ``env_ids``, int64, shape (n,), whose episodes end here."""
        return None, None

    def record_post_reset(self, env_ids: torch.Tensor) -> Record:
        """Return a record of the worlds ``env_ids``, int64, shape (n,), whose episodes start here."""
        return None, None
