# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Recorded steps as learners from demonstrations want them: what was seen, what was done, what came of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from arcgym.managers import Episode, count_episodes, episode_paths
from arcgym.utils.errors import UsageError
from arcgym.utils.string import did_you_mean

STATE = ("poses/tip_pos_w", "poses/tip_quat_w", "poses/inserted_length", "forces/tip")
"""Values that make the state, unless others are named."""
NO_EPISODE = (
    "There is no episode to convert: expected one of two steps or more, with --only_successes one that succeeded."
)
"""What is said where there is nothing to write."""
IMAGE = "images/rgb"
"""Pictures, unless others are named."""


@dataclass(frozen=True)
class Samples:
    """S samples of one episode: each has what was there before an action, the action, and what came after it.

    What is recorded after step t-1 was there before step t; nothing is recorded before the first step, which is
    therefore left out: S = T - 1.
    """

    state: np.ndarray
    """Values before the action, side by side, shape (S, D), float32."""
    next_state: np.ndarray
    """The same after it, shape (S, D)."""
    action: np.ndarray
    """Raw actions, shape (S, A), float32."""
    reward: np.ndarray
    """Reward of the step, shape (S,), float32."""
    image: np.ndarray | None
    """Picture before the action, uint8, shape (S, H, W, 3)."""
    next_image: np.ndarray | None
    """The same after it."""
    task: str
    """Name of the task."""
    success: bool
    """Whether the episode reached its goal."""
    step_dt: float
    """Time of a step [s]."""
    names: tuple[str, ...]
    """Names of the entries of the state, length D."""

    def __len__(self) -> int:
        """Return the number of samples S."""
        return len(self.action)


def recordings(sources: Sequence[Path]) -> list[Path]:
    """Return the finished recordings among files and below folders, in order.

    Raises:
        UsageError: If there are none.
    """
    found: list[Path] = []
    for source in sources:
        folders = [source, *sorted(path for path in source.rglob("*") if path.is_dir())] if source.is_dir() else []
        found += [path for folder in folders for path in episode_paths(folder)] if folders else [source]
    if not found:
        raise UsageError(f"No finished recordings in {', '.join(map(str, sources))}.")
    return found


def read_samples(
    sources: Sequence[Path],
    state: Sequence[str] = STATE,
    image: str | None = IMAGE,
    only_successes: bool = False,
) -> Iterator[Samples]:
    """Read recordings one episode at a time; episodes of fewer than two steps are left out.

    Args:
        sources: Recordings, or folders of them.
        state: Names of the values of steps that make the state.
        image: Name of the pictures; those that are not there are left out.
        only_successes: Whether episodes that did not reach their goal are left out.

    Raises:
        UsageError: If an episode lacks a value.
    """
    for path in recordings(sources):
        for number in range(count_episodes(path)):
            episode = Episode.load(path, number)
            if episode.info["length"] > 1 and (episode.info["success"] or not only_successes):
                yield _samples(path, episode, state, image)


def _samples(path: Path, episode: Episode, state: Sequence[str], image: str | None) -> Samples:
    for name in (*state, "actions", "rewards/total"):
        if name not in episode.steps:
            raise UsageError(f"{path} has no value '{name}' of steps. {did_you_mean(name, sorted(episode.steps))}")
    length = episode.info["length"]
    columns = {name: episode.data[name].reshape(length, -1).astype(np.float32) for name in state}
    joined = np.concatenate(list(columns.values()), axis=1)
    names = [f"{name.rpartition('/')[2]}_{k}" for name, column in columns.items() for k in range(column.shape[1])]
    pictures = episode.data.get(image) if image else None
    return Samples(
        state=joined[:-1],
        next_state=joined[1:],
        action=episode.data["actions"][1:].astype(np.float32),
        reward=episode.data["rewards/total"][1:].astype(np.float32),
        image=None if pictures is None else pictures[:-1],
        next_image=None if pictures is None else pictures[1:],
        task=str(episode.provenance.get("task")),
        success=bool(episode.info["success"]),
        step_dt=float(episode.info["step_dt"]),
        names=tuple(names),
    )
