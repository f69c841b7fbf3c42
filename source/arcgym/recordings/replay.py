# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A recorded episode made again from its start by its actions, and compared bit for bit."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import torch

from arcgym.envs import mdp
from arcgym.managers import Episode
from arcgym.recordings.restoring import put_at_start
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread

COMPARED = ("poses", "forces", "wall")
"""Groups of values that are compared in every step."""


@dataclass(frozen=True)
class Difference:
    """Where a value first leaves the recording."""

    name: str
    """Name of the value."""

    step: int
    """Control step, from 0; the length of the episode for the state at its end."""

    largest: float
    """Largest difference from there to the end, in the value's unit."""

    def __str__(self) -> str:
        """Return the difference in a few words."""
        return f"{self.name} from step {self.step} on, by up to {self.largest:.3g}"


@dataclass
class ReplayResult:
    """What a replay gave."""

    steps: int
    """Control steps made."""

    seconds: float = 0.0
    """Duration [s]."""

    compared: list[str] = field(default_factory=list)
    """Names of the values that were compared."""

    differences: list[Difference] = field(default_factory=list)
    """Values that differ, the earliest first."""

    has_end: bool = True
    """Whether the recording has the complete state at its end; false after a kill."""

    @property
    def is_exact(self) -> bool:
        """Whether every bit is the same."""
        return bool(self.compared) and not self.differences

    def __str__(self) -> str:
        """Return the outcome in one line."""
        if self.is_exact:
            what = f"the state at the end and {len(self.compared)} values" if self.has_end else "no state at the end;"
            values = "" if self.has_end else f" {len(self.compared)} values"
            return f"the same, bit for bit: {what}{values} of all {self.steps} steps"
        if not self.compared:
            return "nothing could be compared: the recording has neither poses, forces nor a state at its end"
        return f"NOT the same: {'; '.join(map(str, self.differences[:5]))}"


def replay(env: Any, episode: Episode, on_step: Callable[[int], None] = lambda step: None) -> ReplayResult:
    """Make an episode again in world 0 and compare it with the recording.

    Args:
        env: Environment of one world as :func:`arcgym.recordings.restoring.restored_cfg` configures it.
        episode: The recording.
        on_step: Called with the number of steps made, before the first and after each.

    Raises:
        UsageError: If the actions do not fit the environment, or the recording has no start.
    """
    actions = episode.data.get("actions")
    dimension = env.action_manager.total_action_dim
    if actions is None or actions.shape[1:] != (dimension,):
        given = "none" if actions is None else f"actions of {actions.shape[1]} values"
        raise UsageError(f"The recording has {given}, expected actions of {dimension} values for this task.")
    env.reset()
    put_at_start(env, episode)
    compare = _Comparison(env, episode)
    start = time.perf_counter()
    with torch.inference_mode(), one_thread():
        on_step(0)
        for step, action in enumerate(actions):
            env.step(torch.as_tensor(action)[None])
            compare.step(step)
            on_step(step + 1)
        compare.end(len(actions))
    result = compare.result(len(actions))
    result.seconds = time.perf_counter() - start
    return result


class _Comparison:
    """Asks the recorder terms what they would record now, and holds it beside the recording."""

    def __init__(self, env: Any, episode: Episode) -> None:
        names = [name for name in episode.steps if name.partition("/")[0] in COMPARED]
        self._episode, self._names = episode, names
        self._terms = [
            mdp.PostStepPosesRecorder(mdp.PreStepObservationsRecorderCfg(), env),
            mdp.PostStepForcesRecorder(mdp.PostStepForcesRecorderCfg(links="forces/link" in names), env),
            mdp.PostStepWallRecorder(mdp.PostStepWallRecorderCfg(positions="wall/positions" in names), env),
        ]
        self._env, self._seen, self._first, self._largest = env, set[str](), dict[str, int](), dict[str, float]()

    def step(self, step: int) -> None:
        """Compare the values of a step."""
        for term in self._terms:
            group, values = term.record_post_step()
            assert isinstance(values, dict)
            for name, value in values.items():
                if f"{group}/{name}" in self._names:
                    self._compare(f"{group}/{name}", self._episode.data[f"{group}/{name}"][step], value[0], step)

    def end(self, step: int) -> None:
        """Compare the complete state."""
        for name, array in self._env.sim.world_arrays().items():
            if f"final_state/{name}" in self._episode.data:
                self._compare(f"final_state/{name}", self._episode.data[f"final_state/{name}"], array[0], step)

    def result(self, steps: int) -> ReplayResult:
        """Return the outcome."""
        found = [Difference(name, step, self._largest[name]) for name, step in self._first.items()]
        has_end = any(name.startswith("final_state/") for name in self._seen)
        compared = sorted(self._seen)
        return ReplayResult(steps, 0.0, compared, sorted(found, key=lambda one: one.step), has_end)

    def _compare(self, name: str, recorded: np.ndarray, value: torch.Tensor, step: int) -> None:
        now = value.cpu().numpy()
        self._seen.add(name)
        if now.shape == recorded.shape and now.tobytes() == recorded.tobytes():
            return
        same_shape = now.shape == recorded.shape
        by = float(np.abs(now.astype(float) - recorded).max()) if same_shape and now.size else math.inf
        by = math.inf if math.isnan(by) else by
        self._first.setdefault(name, step)
        self._largest[name] = max(self._largest.get(name, 0.0), by)
