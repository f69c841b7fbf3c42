# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Runner of behaviour cloning."""

from __future__ import annotations

from rsl_rl.env import VecEnv

from arcgym.rl.runner import OnPolicyRunner


class BehaviorCloningRunner(OnPolicyRunner):
    """The on-policy runner; a run that will be logged reads its demonstrations at once, playing needs none."""

    def __init__(self, env: VecEnv, train_cfg: dict, log_dir: str | None = None, device: str = "cpu"):
        """Build algorithm and logger; arguments as in rsl_rl.

        Raises:
            UsageError: The demonstrations are missing or do not fit the task.
        """
        super().__init__(env, train_cfg, log_dir, device)
        if log_dir is not None:
            demonstrations = self.alg.read_demonstrations()  # type: ignore[attr-defined]
            print(f"demonstrations: {demonstrations.num_episodes} episodes, {len(demonstrations)} steps")
