# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a soak has found, and the file of JSON lines that it is written to as it comes."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from arcgym.utils.lines import append_line

SUMS = (
    *("env_steps", "seconds", "resets", "recovered_worlds", "disturbed_worlds", "pierced", "pierced_lightly"),
    *("outside_links", "examined_links", "dropped_contacts", "missed_contacts", "touching_pairs", "contact_samples"),
)
"""Findings that add up over the parts of a soak."""
BEGINNING = '{"kind": '
"""Beginning of every line of a journal."""


@dataclass
class Tally:
    """Findings in one task over a number of control steps."""

    env_steps: int = 0
    """Control steps, over all worlds."""
    seconds: float = 0.0
    """Time that they took [s]."""
    resets: int = 0
    """Worlds reset."""
    recovered_worlds: int = 0
    """Worlds reset because their state was not finite."""
    disturbed_worlds: int = 0
    """Worlds whose state another world's reset changed."""
    pierced: int = 0
    """Episodes that ended because a link was going through the wall."""
    pierced_lightly: int = 0
    """Those of them with less on the tip and on 50 mm of scope than perforates a colon, see ``force_tiers``."""
    outside_links: int = 0
    """Links found outside the lumen."""
    examined_links: int = 0
    """Links examined for that."""
    dropped_contacts: int = 0
    """Contacts that found no room."""
    missed_contacts: int = 0
    """Pairs of a link and a face of the wall that touched without a contact, in samples of single worlds."""
    touching_pairs: int = 0
    """Pairs that touched in these samples, found by looking at all pairs."""
    contact_samples: int = 0
    """Number of these samples."""
    not_finite: dict[str, int] = field(default_factory=dict)
    """Worlds with a number that is not finite, by observation, reward, state or force."""
    largest: dict[str, dict[str, float]] = field(default_factory=dict)
    """Largest value of each quantity, by kind of action."""
    host_growth_mib: float = 0.0
    """Growth of the process's memory in a session that came to its end, after its first quarter [MiB]."""
    device_growth_mib: float = 0.0
    """The same for the memory in use on the GPU [MiB]."""
    problems: list[str] = field(default_factory=list)
    """What the checks of recovery and isolation found wrong."""

    def add(self, other: Tally) -> None:
        """Take in what a later part of the soak found."""
        for name in SUMS:
            setattr(self, name, getattr(self, name) + getattr(other, name))
        for name, count in other.not_finite.items():
            self.not_finite[name] = self.not_finite.get(name, 0) + count
        for quantity, by_kind in other.largest.items():
            mine = self.largest.setdefault(quantity, {})
            for kind, value in by_kind.items():
                mine[kind] = max(mine.get(kind, 0.0), value)
        self.host_growth_mib = max(self.host_growth_mib, other.host_growth_mib)
        self.device_growth_mib = max(self.device_growth_mib, other.device_growth_mib)
        self.problems += other.problems

    def violations(self, growth_mib: float) -> list[str]:
        """Say what must not be; empty if all is well.

        Args:
            growth_mib: Largest growth of memory that is tolerated [MiB].
        """
        found = list(self.problems)
        found += [f"{name} was not finite in {count} worlds" for name, count in self.not_finite.items()]
        counts = {
            "worlds had to be recovered": self.recovered_worlds,
            "worlds were changed by another world's reset": self.disturbed_worlds,
            f"of {self.examined_links} links were outside the lumen": self.outside_links,
            "contacts found no room": self.dropped_contacts,
            f"of {self.touching_pairs} pairs that touch were missed": self.missed_contacts,
        }
        found += [f"{count} {what}" for what, count in counts.items() if count]
        growth = {"host": self.host_growth_mib, "device": self.device_growth_mib}
        return found + [f"{name} memory grew by {g:.0f} MiB" for name, g in growth.items() if g > growth_mib]


class Journal:
    """File of JSON lines: ``start`` of a session, ``part`` (tally of some steps), ``event`` (world and step)."""

    def __init__(self, path: Path) -> None:
        """Read what the file holds already.

        Raises:
            ValueError: If a line of it is no JSON object with a kind and a task. The beginning of a line, left by a
                process that was killed while it wrote, is left out.
        """
        self.path = path
        self.lines: list[dict[str, Any]] = []
        if path.is_file():
            texts = enumerate(path.read_text().splitlines(), 1)
            self.lines = [self._parse(number, text) for number, text in texts if not _is_torn(text)]

    def _parse(self, number: int, text: str) -> dict[str, Any]:
        try:
            line = json.loads(text)
            return {**line, "kind": line["kind"], "task": line["task"]}
        except (ValueError, KeyError, TypeError) as error:
            raise ValueError(f"{self.path}, line {number} is not of a soak: {text[:60]!r} ({error!r})") from error

    def write(self, kind: str, task: str, **content: Any) -> None:
        """Append a line."""
        line = {"kind": kind, "task": task, **content}
        self.lines.append(line)
        append_line(self.path, json.dumps(line))

    def sessions(self, task: str) -> int:
        """Return how often the task was started."""
        return len(self._of("start", task))

    def events(self, task: str) -> list[dict[str, Any]]:
        """Return the worlds of a task in which something was found, with seed, step and kind of action."""
        return self._of("event", task)

    def tally(self, task: str) -> Tally:
        """Return the findings in the task in all sessions."""
        total = Tally()
        for line in self._of("part", task):
            total.add(Tally(**line["tally"]))
        return total

    def write_part(self, task: str, tally: Tally) -> None:
        """Append the findings of some steps."""
        self.write("part", task, tally=asdict(tally))

    def _of(self, kind: str, task: str) -> list[dict[str, Any]]:
        return [line for line in self.lines if line["kind"] == kind and line["task"] == task]


def _is_torn(text: str) -> bool:
    """Return whether a line is the beginning of one, left by a process that was killed while it wrote."""
    try:
        json.loads(text)
    except ValueError:
        return text.startswith(BEGINNING) or BEGINNING.startswith(text)
    return False
