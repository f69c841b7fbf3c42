# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Recorded episodes as observations and actions to imitate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch
from tensordict import TensorDict

from arcgym.managers.recorder_files import Episode, episode_paths
from arcgym.utils.errors import UsageError


class Demonstrations:
    """Steps of recorded episodes in memory, for drawing batches of them."""

    def __init__(self, folder: str | Path, groups: list[str], device: str, successful_only: bool = True):
        """Read the episodes that a recorder wrote, with ``obs/<group>`` and ``actions``.

        Args:
            folder: Folder of the episodes.
            groups: Observation groups to read.
            device: Where the steps are kept.
            successful_only: Whether episodes that the task's success did not end are left out.

        Raises:
            UsageError: If there is no episode, or none that succeeded, or one lacks an observation group.
        """
        paths = episode_paths(folder)
        episodes = [episode for path in paths if (episode := Episode.load(path)).info["success"] or not successful_only]
        if not episodes:
            wanted = "successful episodes" if successful_only else "episodes"
            raise UsageError(f"No {wanted} in '{folder}', which holds {len(paths)} recorded episodes.")
        self.num_episodes = len(episodes)
        names = {group: f"obs/{group}" for group in groups} | {"actions": "actions"}
        for path_name in names.values():
            _check(episodes, path_name, folder)
        joined = {
            key: torch.from_numpy(np.concatenate([episode.data[name] for episode in episodes])).to(device)
            for key, name in names.items()
        }
        self.actions = joined.pop("actions").float()
        self.observations = TensorDict(joined, batch_size=[len(self.actions)], device=device)

    def __len__(self) -> int:
        """Return the number of steps."""
        return len(self.actions)

    def sample(self, batch_size: int) -> tuple[TensorDict, torch.Tensor]:
        """Return observations and actions, shape (B, A), of steps drawn with replacement."""
        index = torch.randint(len(self), (batch_size,), device=self.actions.device)
        return self.observations[index], self.actions[index]


def _check(episodes: list[Episode], name: str, folder: str | Path) -> None:
    for episode in episodes:
        if name not in episode.data:
            raise UsageError(
                f"An episode in '{folder}' has no '{name}'; it holds: {', '.join(sorted(episode.data))}. Record with "
                "env.recorders.observations set to PreStepObservationsRecorderCfg()."
            )
