# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Recorded episodes as observations and actions to imitate."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import torch
from tensordict import TensorDict

from arcgym.managers.recorder_files import Episode, episode_paths, open_recording
from arcgym.utils.errors import UsageError


class Demonstrations:
    """Observations and actions of steps in memory, for drawing batches of them."""

    def __init__(self, observations: TensorDict, actions: torch.Tensor, num_episodes: int):
        """Keep the steps.

        Args:
            observations: What each action was chosen from, batch of steps.
            actions: Raw actions, shape (steps, A).
            num_episodes: Episodes that they are of.
        """
        self.observations, self.actions, self.num_episodes = observations, actions, num_episodes

    def __len__(self) -> int:
        """Return the number of steps."""
        return len(self.actions)

    def add(self, observations: TensorDict, actions: torch.Tensor) -> None:
        """Keep further steps; arguments as of the constructor."""
        self.observations = torch.cat([self.observations, observations])  # type: ignore[assignment]
        self.actions = torch.cat([self.actions, actions])

    def sample(self, batch_size: int) -> tuple[TensorDict, torch.Tensor]:
        """Return observations and actions, shape (B, A), of steps drawn with replacement."""
        index = torch.randint(len(self), (batch_size,), device=self.actions.device)
        return self.observations[index], self.actions[index]


def read_demonstrations(
    folder: str | Path, groups: list[str], device: str, successful_only: bool = True
) -> Demonstrations:
    """Read the episodes that a recorder wrote, with ``obs/<group>`` and ``actions``.

    Args:
        folder: Folder of the episodes, or a data set of ``arcgym record`` with a folder for each patient.
        groups: Observation groups to read.
        device: Where the steps are kept.
        successful_only: Whether episodes that the task's success did not end are left out.

    Raises:
        UsageError: If there is no episode, or none that succeeded, or one lacks an observation group.
    """
    paths = _paths(folder)
    episodes = [episode for path in paths if (episode := Episode.load(path)).info["success"] or not successful_only]
    if not episodes:
        wanted = "successful episodes" if successful_only else "episodes"
        raise UsageError(f"No {wanted} in '{folder}', which holds {len(paths)} recorded episodes.")
    names = {group: f"obs/{group}" for group in groups} | {"actions": "actions"}
    for path_name in names.values():
        _check(episodes, path_name, folder)
    joined = {
        key: torch.from_numpy(np.concatenate([episode.data[name] for episode in episodes])).to(device)
        for key, name in names.items()
    }
    actions = joined.pop("actions").float()
    return Demonstrations(TensorDict(joined, batch_size=[len(actions)], device=device), actions, len(episodes))


def demonstrated_patients(folder: str | Path) -> list[str]:
    """Return the stages of the patients in a folder's recorded episodes, each once; none where nothing is recorded."""
    found: dict[str, None] = {}
    for path in _paths(folder):
        with open_recording(path) as file:
            for demo in file["data"].values():
                found[json.loads(demo.attrs["provenance"])["stages"]["colon"]["path"]] = None
    return list(found)


def _paths(folder: str | Path) -> list[Path]:
    """Return the finished episodes in a folder and the folders right below it."""
    folders = [Path(folder), *sorted(path for path in Path(folder).glob("*") if path.is_dir())]
    return [path for place in folders for path in episode_paths(place)]


def _check(episodes: list[Episode], name: str, folder: str | Path) -> None:
    for episode in episodes:
        if name not in episode.data:
            raise UsageError(
                f"An episode in '{folder}' has no '{name}'; it holds: {', '.join(sorted(episode.data))}. Record with "
                "--observations, or env.recorders.observations set to PreStepObservationsRecorderCfg()."
            )
