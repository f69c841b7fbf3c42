# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Experts that write down every control step, so that the history of any world can be read afterwards."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch

from arcgym.anatomy.segments import SEGMENTS
from arcgym.assets.materials import MESOCOLON_HEIGHT
from arcgym.envs.mdp.shaft_metrics import find_loops
from arcgym.experts import ExaminerExpert, PushExpert
from arcgym.scene.interactive_scene import InteractiveScene

FIELDS = ("inserted", "arc", "push", "torque", "segment", "loop", "mesentery", "attachments", "shaft", "went_on")
"""What is written down of a control step: scope inside [m], arc length of the tip [m], push on the base, mean over the
step [N], torque on it [N m], segment of the tip, kind of loop, largest pull of a ring on its mesentery and on any
attachment [N], largest force of the wall on 50 mm of scope [N], and whether the step followed the one before it: worlds
that work together go on from others' states, and forces are zero in the first step after that."""
HANGING = tuple(SEGMENTS.index(name) for name in MESOCOLON_HEIGHT)
"""Segments that hang on a mesentery."""


class Diary(PushExpert):
    """An expert of a pushed scope that writes down what it does.

    Every control step of a world is an entry that knows the one before it. Who takes over another world's state takes
    over its last entry with the rest of its memory, so that going back from the last entry gives one continuous
    insertion, whoever made its parts.
    """

    def __init__(self, scene: InteractiveScene, **settings: Any):
        """Start a diary."""
        super().__init__(scene, **settings)
        count = scene.num_envs
        self._last = torch.full((count,), -1, dtype=torch.long, device=scene.device)
        self._worlds = torch.arange(count, device=scene.device)
        self._rows: list[torch.Tensor] = []
        self._before: list[torch.Tensor] = []
        self._past: list[np.ndarray] = []

    def act(self) -> None:
        """Write the last control step down and set the commands of the next."""
        newest = self._worlds + (len(self._rows) - 1) * len(self._worlds)
        kept = (self._last == newest) & (newest >= 0)
        self._rows.append(torch.stack([*measure(self.scene), kept.float()], dim=1))
        self._before.append(self._last.clone())
        self._last.copy_(self._worlds + (len(self._rows) - 1) * len(self._worlds))
        super().act()

    def memory(self) -> list[torch.Tensor]:
        """Return what the expert remembers, and each world's last entry."""
        return [*super().memory(), self._last]

    def entry(self, world: int) -> int:
        """Return the number of a world's last entry."""
        return int(self._last[world])

    def histories(self, entries: list[int]) -> list[np.ndarray]:
        """Return the insertions that end with some entries, each of shape (T, F): F fields, see :data:`FIELDS`."""
        rows = torch.stack(self._rows).flatten(0, 1).cpu().numpy()
        before = torch.stack(self._before).flatten().cpu().numpy()
        return [np.concatenate([self._past_of(before, entry), rows[lineage(before, entry)]]) for entry in entries]

    def add_past(self, histories: list[np.ndarray]) -> int:
        """Keep insertions of an earlier drive, and return the number of the first, see :func:`past_code`."""
        self._past += histories
        return len(self._past) - len(histories)

    def _past_of(self, before: np.ndarray, entry: int) -> np.ndarray:
        """Return the insertion of an earlier drive that one of this drive goes on from; empty if none."""
        entries = lineage(before, entry)
        root = int(before[entries[0]]) if entries else entry
        return self._past[past_code(root)] if root < -1 else np.empty((0, len(FIELDS)), np.float32)


class RecordedPushExpert(Diary):
    """The shipped expert of a pushed scope, with a diary."""


class RecordedExaminer(Diary, ExaminerExpert):
    """The expert that pushes gently and pulls back, with a diary."""


def past_code(number: Any) -> Any:
    """Return what stands for the entry before the first of an insertion that goes on from that number of the past.

    -2 for 0, -3 for 1 and so on, for -1 is none; the same function turns it back.
    """
    return -2 - number


def lineage(before: np.ndarray, last: int) -> list[int]:
    """Return the numbers of the entries up to ``last``, from the first.

    Args:
        before: Number of the entry before each entry, -1 for none, shape (E,).
        last: Number of the last entry.
    """
    found = []
    while last >= 0:
        found.append(int(last))
        last = int(before[last])
    return found[::-1]


def measure(scene: InteractiveScene) -> list[torch.Tensor]:
    """Return the fields of the present step but for the last, each of shape (N,), without waiting for the device."""
    scope, colon = scene["endoscope"].data, scene["colon"].data
    arc = colon.centerline_arc
    hangs = torch.zeros_like(arc, dtype=torch.bool)
    for segment in HANGING:
        start, end = colon.segment_spans[:, segment].unbind(dim=1)
        hangs |= (arc >= start[:, None]) & (arc < end[:, None])
    tension = colon.anchor_tension
    return [
        scope.inserted_length,
        scope.tip_arc_length.clone(),
        scope.base_force.clone(),
        base_torque(scene),
        scope.tip_segment.float(),
        find_loops(scene).float(),
        torch.where(hangs, tension, 0.0).amax(dim=1),
        tension.amax(dim=1),
        scope.window_force_norm.amax(dim=1),
    ]


def base_torque(scene: InteractiveScene) -> torch.Tensor:
    """Return the torque on the base by the law of its drive, at the end of the control step [N m], shape (N,)."""
    scope, drive = scene["endoscope"].data, scene["endoscope"].stage.roll_drive
    limit = scene["endoscope"].actuators["base"].torque_limit
    turn = scope.joint_pos_target[:, 1] - scope.joint_pos[:, 1]
    return (drive.stiffness * turn - drive.damping * scope.joint_vel[:, 1]).clamp(-limit, limit)
