# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Recorded episodes: one HDF5 file each, in the layout of Isaac Lab and robomimic."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np

FORMAT = 1
"""Version of the layout; readers refuse a higher one."""
SUFFIX = ".hdf5"
"""End of the names of recordings."""
PARTIAL = f".partial{SUFFIX}"
"""End of the name of an episode that is under way, or was when its program was killed."""


class RecordingError(ValueError):
    """A file is no recording, or one that this version cannot read."""


@dataclass(frozen=True)
class Episode:
    """One recorded episode of T control steps."""

    data: dict[str, np.ndarray]
    """Arrays by name: values of steps, shape (T, ...), and values of the episode."""

    info: dict[str, Any]
    """``length`` T, ``step_dt`` [s], ``env_id``, ``complete``, ``success``, ``terminated``, ``time_out``, ``ended_by``
    (termination terms) and ``metrics`` by name; ``recovered`` in place of most of these after a kill."""

    provenance: dict[str, Any] = field(default_factory=dict)
    """Where it comes from: ``task``, ``seed``, ``device``, ``versions``, hashes of ``stages``, ``settings`` (hash)."""

    settings: dict[str, Any] = field(default_factory=dict)
    """Configuration of the environment as plain values."""

    steps: frozenset[str] = frozenset()
    """Names of the values of steps."""

    @staticmethod
    def load(path: str | Path, number: int = 0) -> Episode:
        """Read an episode of a file.

        Args:
            path: The file, also one whose writer was killed.
            number: Which of its episodes.

        Raises:
            RecordingError: If the file holds no such episode, or is of a later version.
        """
        with open_recording(path) as file:
            name = f"data/demo_{number}"
            if name not in file:
                raise RecordingError(f"{path} has no '{name}'; it holds {len(file['data'])} episodes.")
            return _read(file, file[name])


def open_recording(path: str | Path) -> h5py.File:
    """Open a recording to read, also one that is being written or whose writer was killed.

    Raises:
        RecordingError: If it is none, or of a later version.
    """
    try:
        file = h5py.File(path, "r", libver="latest", swmr=True)
    except FileNotFoundError as error:
        raise RecordingError(f"There is no recording '{path}'.") from error
    except OSError as error:
        if Path(path).is_dir():
            names = sorted(file.name for file in Path(path).glob(f"*{SUFFIX}"))[:5]
            has = f"a file in it, such as {', '.join(names)}" if names else f"a file ending in {SUFFIX}"
            raise RecordingError(f"{path} is a folder, expected {has}.") from error
        raise RecordingError(f"{path} is no HDF5 file: {error}") from error
    version = file.attrs.get("arcgym_recording")
    if version is None or "data" not in file or version > FORMAT:
        file.close()
        what = "is no recording of ARCGym" if version is None else f"is a recording of version {version}"
        raise RecordingError(f"{path} {what}; expected version {FORMAT} or lower.")
    return file


def count_episodes(path: str | Path) -> int:
    """Return the number of episodes in a file."""
    with open_recording(path) as file:
        return len(file["data"])


def episode_paths(folder: str | Path) -> list[Path]:
    """Return the finished episodes in a folder, in the order in which they were begun."""
    return sorted(path for path in Path(folder).glob(f"*_[0-9]*{SUFFIX}") if not path.name.endswith(PARTIAL))


def load_episodes(source: str | Path) -> Iterator[Episode]:
    """Read one by one the episodes of a file, or the finished ones of a folder."""
    source = Path(source)
    for path in [source] if source.is_file() else episode_paths(source):
        for number in range(count_episodes(path)):
            yield Episode.load(path, number)


def next_path(folder: str | Path, name: str) -> Path:
    """Return the first path ``<name>_000000.hdf5``, ``<name>_000001.hdf5``, ... after all that exist in a folder."""
    number = re.compile(rf"{re.escape(name)}_(\d+)(?:\.partial)?\{SUFFIX}")
    found = (number.fullmatch(path.name) for path in Path(folder).glob(f"{name}_*"))
    taken = [int(match[1]) for match in found if match]
    return Path(folder) / f"{name}_{max(taken, default=-1) + 1:06d}{SUFFIX}"


def claim_path(folder: str | Path, name: str) -> Path:
    """Return :func:`next_path` once the empty beginning of its episode is there: no other process gets the same."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    while True:
        path = next_path(folder, name)
        try:
            partial_path(path).touch(exist_ok=False)
        except FileExistsError:
            continue
        return path


def partial_path(path: Path) -> Path:
    """Return the name that an episode's file has until it is finished."""
    return path.with_name(path.name.removesuffix(SUFFIX) + PARTIAL)


def _read(file: h5py.File, group: h5py.Group) -> Episode:
    arrays: dict[str, h5py.Dataset] = {}
    group.visititems(lambda name, item: arrays.update({name: item}) if isinstance(item, h5py.Dataset) else None)
    steps = frozenset(name for name, item in arrays.items() if item.maxshape[:1] == (None,))
    length = min((arrays[name].shape[0] for name in steps), default=0)
    data = {name: item[:length] if name in steps else item[()] for name, item in arrays.items()}
    provenance = json.loads(group.attrs.get("provenance", "{}"))
    settings = file.get(f"settings/{provenance.get('settings')}")
    info = json.loads(group.attrs["info"]) if "info" in group.attrs else {"success": False, "recovered": True}
    return Episode(
        {name: np.asarray(value) for name, value in data.items()},
        {"complete": False, "step_dt": provenance.get("step_dt"), **info, "length": length},
        provenance,
        json.loads(settings[()]) if settings is not None else {},
        steps,
    )
