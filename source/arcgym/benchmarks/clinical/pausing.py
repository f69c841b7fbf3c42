# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Insertions that ran out of computing time: what another call needs to go on with them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from arcgym.benchmarks.clinical.record import Diary, past_code
from arcgym.start_states import Drive
from arcgym.start_states.halts import Halt, go_on, halt_of
from arcgym.utils.array_files import load_arrays, save_arrays


@dataclass
class Pause:
    """One patient of a drive that was stopped: its worlds, and the insertions that they and its trail come from."""

    halt: Halt
    """States and memories; last entries are codes of the insertions, see :func:`.record.past_code`."""
    histories: list[np.ndarray]
    """Insertions, each of shape (T, F)."""


def pause(drive: Drive, diary: Diary, patient: int, path: Path) -> None:
    """Write down a patient of a drive that is stopped."""
    halt, place = halt_of(drive, patient), len(diary.memory()) - 1
    columns = [memory[place] for memory in (halt.memory, halt.trail_memory) if memory]
    entries = np.unique(np.concatenate(columns))
    for column in columns:
        column[:] = past_code(np.searchsorted(entries, column))
    save_arrays(Pause(halt, diary.histories(entries.tolist())), path)


def resume(drive: Drive, diary: Diary, patient: int, path: Path) -> None:
    """Go on with a patient that :func:`pause` wrote down, before :meth:`Drive.run`; nothing without a file.

    Raises:
        ValueError: If it belongs to another patient or scope.
    """
    found = load_arrays(path)
    if not isinstance(found, Pause):
        return
    first, place = diary.add_past(found.histories), len(diary.memory()) - 1
    for memory in (found.halt.memory, found.halt.trail_memory):
        if memory:
            memory[place] = memory[place] - first
    go_on(drive, patient, found.halt)
