# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Runner of algorithms that learn from a replay memory."""

from __future__ import annotations

import os
from pathlib import Path

import torch
from rsl_rl.env import VecEnv

from arcgym.rl.runner import OnPolicyRunner

REPLAY_FILE = "replay.pt"
"""Name of the saved memory, beside the checkpoints."""


class OffPolicyRunner(OnPolicyRunner):
    """The on-policy runner's loop, log and checkpoints, for an algorithm with a ``replay``.

    It makes the environment return final observations. On request the memory is saved beside each checkpoint, one file
    for the newest; without it a resumed run fills its memory again, acting with the trained policy.
    """

    def __init__(self, env: VecEnv, train_cfg: dict, log_dir: str | None = None, device: str = "cpu"):
        """Build algorithm and logger; arguments as in rsl_rl."""
        env.unwrapped.cfg.compute_final_obs = True  # type: ignore[attr-defined]
        super().__init__(env, train_cfg, log_dir, device)
        self.saves_replay = bool(train_cfg.get("save_replay", False))

    def describe_models(self) -> str:
        """Return one line for the networks and one for the memory."""
        replay = self.alg.replay  # type: ignore[attr-defined]
        size = replay.num_bytes / 2**20
        return f"{super().describe_models()}\nreplay: {replay.num_rows} rows x {replay.num_envs} worlds, {size:.1f} MiB"

    def save(self, path: str, infos: dict | None = None) -> None:
        """Write a checkpoint, and the memory if the configuration asks for it."""
        super().save(path, infos)
        if self.saves_replay and Path(path).name != "model_best.pt":
            file = Path(path).with_name(REPLAY_FILE)
            temporary = Path(f"{file}.tmp")
            try:
                torch.save(self.alg.replay.state_dict(), temporary)  # type: ignore[attr-defined]
                os.replace(temporary, file)
            except (OSError, RuntimeError) as error:  # torch raises either on a full disk
                temporary.unlink(missing_ok=True)
                print(f"replay memory {file} not written: {error}; training goes on", flush=True)

    def load(
        self, path: str, load_cfg: dict | None = None, strict: bool = True, map_location: str | None = None
    ) -> dict:
        """Load a checkpoint and, when the whole state is asked for, the memory that lies beside it."""
        infos = super().load(path, load_cfg, strict, map_location)
        file = Path(path).with_name(REPLAY_FILE)
        if load_cfg is None and self.saves_replay and file.is_file():
            state = torch.load(file, weights_only=True, map_location=map_location or self.device)
            self.alg.replay.load_state_dict(state)  # type: ignore[attr-defined]
        return infos
