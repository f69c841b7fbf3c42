# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A recording made again piece by piece, each from the complete state at a mark.

Contact amplifies a difference in the last bit, so that a long insertion made on another kind of processor, or after a
change of the physics that hardly matters, ends elsewhere. From mark to mark there is no time for that.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch

from arcgym.managers import Episode
from arcgym.recordings.restoring import put_in_state
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread

STATE, SETTINGS = "marks/state/", "world_settings/"
"""Beginnings of the names of the states at marks, and of the physical settings of the recorded world."""


@dataclass(frozen=True)
class Piece:
    """What came of the way from one mark to the next."""

    start: int
    """Control step of the mark that it begins at."""

    end: int
    """Control step at which it ends."""

    tip_distance: float
    """Distance of the tip from the recorded one at the end [m]."""

    is_exact: bool
    """Whether the tip is where it was, bit for bit, in every step."""

    def __str__(self) -> str:
        """Return the outcome in a few words."""
        off = f"the tip ends {1000.0 * self.tip_distance:.2f} mm off"
        return f"steps {self.start} to {self.end}: {'the same, bit for bit' if self.is_exact else off}"


def mark_steps(episode: Episode) -> list[int]:
    """Return the control steps of the marks whose states a recording holds, in order.

    Raises:
        UsageError: If it holds none.
    """
    if "marks/step" not in episode.data:
        raise UsageError("The recording has no marks with complete states: replay it as a whole.")
    return [int(step) for step in episode.data["marks/step"]]


def replay_pieces(
    env: Any, episode: Episode, pieces: slice = slice(None), on_step: Callable[[int], None] = lambda step: None
) -> list[Piece]:
    """Make a recording again from mark to mark, and to its end, in world 0.

    Args:
        env: Environment of one world as :func:`arcgym.recordings.restoring.restored_cfg` configures it.
        episode: The recording, with the states at its marks and the positions of its tip.
        pieces: Which of the pieces.
        on_step: Called with the number of the step after each.
    """
    steps = mark_steps(episode)
    ends = [*steps[1:], int(episode.info["length"])]
    env.reset()
    with torch.inference_mode(), one_thread():
        chosen = list(enumerate(zip(steps, ends, strict=True)))[pieces]
        return [_piece(env, episode, mark, start, end, on_step) for mark, (start, end) in chosen if start < end]


def _piece(env: Any, episode: Episode, mark: int, start: int, end: int, on_step: Callable[[int], None]) -> Piece:
    data, scope = episode.data, env.scene["endoscope"].data
    state = {name.removeprefix(STATE): value[mark] for name, value in data.items() if name.startswith(STATE)}
    settings = {name.removeprefix(SETTINGS): value for name, value in data.items() if name.startswith(SETTINGS)}
    put_in_state(env, state, settings)
    env.action_manager.resume(start)
    exact, there = True, np.zeros(3)
    for step in range(start, end):
        env.step(torch.as_tensor(data["actions"][step])[None])
        there = scope.tip_pos_w[0].cpu().numpy()
        exact = exact and np.array_equal(there, data["poses/tip_pos_w"][step])
        on_step(step + 1)
    distance = float(np.linalg.norm(there - data["poses/tip_pos_w"][end - 1]))
    return Piece(start, end, distance, exact)
