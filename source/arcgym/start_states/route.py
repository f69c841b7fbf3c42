# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How far a drive has come in one patient, and what it met there."""

from __future__ import annotations

from dataclasses import dataclass, field

import torch

from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import Snapshot

GAIN = 0.005
"""Way within the patience that counts as progress [m]."""
AT_LIMIT = 0.9
"""Share of the largest push from which the drive counts as at its limit."""
NEAR_TIP = 0.06
"""Distance from the front of the tip within which a force is the tip's, not the shaft's [m]."""


@dataclass
class Entry:
    """How a segment was entered."""

    time: float
    """Simulated time since the rest pose [s]."""
    tip_peak: float
    """Largest force of the wall on the tip so far [N]."""
    window_peak: float
    """Largest force of the wall on 50 mm of scope so far [N]."""
    drive_peak: float
    """Largest push on the base, or pull on a tip whose base is not driven, so far [N]."""
    inserted: float = 0.0
    """Largest length of scope that was inside so far [m]."""


@dataclass
class Route:
    """What a drive leaves of one patient."""

    bounds: dict[str, tuple[float, float]]
    """Arc length at start and end of each segment [m]."""
    until: str = ""
    """Last segment to enter."""
    entries: dict[str, Entry] = field(default_factory=dict)
    """How each segment was entered."""
    states: dict[str, Snapshot] = field(default_factory=dict)
    """State at the start of each segment entered."""
    arc: float = 0.0
    """Largest arc length of a tip [m]."""
    time: float = 0.0
    """Simulated time until the end [s]."""
    before: float = 0.0
    """Simulated time that an earlier drive took, from which this one goes on [s]."""
    problem: str = ""
    """Why it ended early; empty while it has not."""
    held_by: str = ""
    """What held the foremost world when it ended early."""
    _progress: tuple[float, float] = (0.0, 0.0)

    @property
    def running(self) -> bool:
        """Whether the drive goes on in this patient."""
        return self.until not in self.entries and not self.problem

    @property
    def failure(self) -> str:
        """Why it ended early and what held it; empty while it has not."""
        return ": ".join(filter(None, (self.problem, self.held_by)))

    def advance(self, arc: float, time: float) -> list[str]:
        """Take note of the foremost tip, and return the segments that it has entered since.

        Args:
            arc: Its arc length [m].
            time: Simulated time of this drive [s].
        """
        self.arc, self.time = max(self.arc, arc), self.before + time
        if arc > self._progress[0] + GAIN:
            self._progress = (arc, self.time)
        return [name for name, (start, _) in self.bounds.items() if arc > start and name not in self.entries]

    def watch(self, patience: float, max_time: float) -> None:
        """Give up where the tip no longer gets on for ``patience`` [s], or after ``max_time`` [s]."""
        if self.time - self._progress[1] > patience:
            self.problem = f"no progress in {patience:g} s"
        if self.time > max_time:
            self.problem = f"not there after {max_time:g} s"


class Peaks:
    """Largest forces of each world since the rest pose, and most scope inside, also of those that it took over from."""

    def __init__(self, scene: InteractiveScene):
        """Start at zero."""
        self._data = scene["endoscope"].data
        self._values = torch.zeros(scene.num_envs, 4, device=scene.device)

    @property
    def memory(self) -> list[torch.Tensor]:
        """What it remembers of every world, N entries each."""
        return [self._values]

    def update(self) -> None:
        """Take note of the forces of the last control step."""
        data = self._data
        drive = torch.maximum(data.base_force.abs(), data.tip_pull_force_w.norm(dim=1))
        now = torch.stack([data.tip_force_peak, data.window_force_peak.amax(dim=1), drive, data.inserted_length], dim=1)
        torch.maximum(self._values, now.nan_to_num(), out=self._values)

    def take_over(self, moved: torch.Tensor, sources: torch.Tensor) -> None:
        """Let worlds go on from what others have met."""
        self._values[moved] = self._values[sources]

    def entry(self, world: int, time: float) -> Entry:
        """Return the entry of a world into a segment at a time [s]."""
        return Entry(round(time, 3), *(round(value, 3) for value in self._values[world].tolist()))


def what_holds(scene: InteractiveScene, world: int) -> str:
    """Say in words what holds the scope of a world that does not get on."""
    data, endoscope = scene["endoscope"].data, scene["endoscope"]
    forces = data.window_force_norm[world]
    window = int(forces.argmax())
    place, force = float(data.window_arc[window]), float(forces[window])
    where = "the tip" if place <= NEAR_TIP else f"the shaft {100.0 * place:.0f} cm behind the tip"
    said = f"{force:.1f} N of the wall on {where}"
    base = endoscope.actuators.get("base")
    if base is None:
        pull = float(data.tip_pull_force_w[world].norm())
        return f"{said}, pull {pull:.1f} N, wall {float(forces.sum()) / 2.0:.1f} N in all"
    push, inserted = float(data.base_force[world]), float(data.inserted_length[world])
    if push > AT_LIMIT * base.force_limit:
        said = f"push at its limit of {base.force_limit:g} N, {said}"
    looped = inserted - float(data.tip_arc_length[world])
    return f"{said}, push {push:.1f} N, {inserted:.2f} m inserted ({looped:+.2f} m over the way)"
