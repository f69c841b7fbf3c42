# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Writes an episode as it comes: a kill loses what was not handed over, and leaves a file that can be read."""

from __future__ import annotations

import json
import os
import resource
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import h5py
import numpy as np

from arcgym.managers.recorder_chunks import LEVEL, write_chunk
from arcgym.managers.recorder_files import FORMAT, Episode, partial_path


class EpisodeWriter:
    """Appends steps to ``<name>.partial.hdf5``, which :meth:`finish` gives its final name.

    The file is written in HDF5's single-writer mode, in which it can be read at any time, by others too.
    """

    def __init__(self, path: Path, provenance: dict[str, Any], settings: dict[str, Any], rows: int) -> None:
        """Prepare the file; it appears with the first steps.

        Args:
            path: Final name of the file.
            provenance: Where the episode comes from, see :class:`arcgym.managers.Episode`.
            settings: Configuration of the environment as plain values.
            rows: Steps of a chunk, which are compressed together; append as many at a time.
        """
        self.path, self.length = path, 0
        self._partial = partial_path(path)
        self._provenance, self._settings, self._rows = provenance, settings, rows
        self._file: h5py.File | None = None

    @property
    def begins_chunk(self) -> bool:
        """Whether the next step is the first of a chunk."""
        return self.length % self._rows == 0

    def append(
        self,
        steps: Mapping[str, np.ndarray],
        once: Mapping[str, np.ndarray],
        packed: Mapping[str, bytes] = MappingProxyType({}),
    ) -> None:
        """Write steps, each of shape (T, ...).

        Args:
            steps: Values of the steps, the same names each time.
            once: Values of the episode so far; only those of the first call are written here.
            packed: Chunks that hold some of the steps' values, see :func:`arcgym.managers.recorder_chunks.pack`;
                only where :attr:`begins_chunk`.
        """
        count = len(next(iter(steps.values())))
        if self._file is None:
            self._create(steps, once)
        assert self._file is not None
        group = self._file["data/demo_0"]
        for name, value in steps.items():
            dataset = group[name]
            dataset.resize(self.length + count, axis=0)
            if name in packed:
                write_chunk(dataset, self.length, packed[name])
            else:
                dataset[self.length :] = value
        self._file.flush()
        self.length += count

    def shorten(self, length: int) -> None:
        """Keep the first ``length`` steps alone."""
        if length >= self.length or self._file is None:
            return
        file = self._reopen()
        file["data/demo_0"].visititems(lambda _, item: _shorten(item, length))
        file.swmr_mode = True
        self._file, self.length = file, length

    def finish(self, once: Mapping[str, np.ndarray], info: dict[str, Any]) -> Path:
        """Write what is known at the end, and give the file its name."""
        file = self._reopen()
        group = file["data/demo_0"]
        for name, value in once.items():
            if name in group:
                del group[name]
            _once(group, name, value)
        group.attrs["num_samples"] = self.length
        group.attrs["success"] = bool(info["success"])
        group.attrs["info"] = json.dumps(info)
        file["data"].attrs["total"] = self.length
        file.close()
        self._file = None
        os.replace(self._partial, self.path)
        return self.path

    def discard(self) -> None:
        """Remove the file."""
        if self._file is not None:
            self._file.close()
            self._file = None
        self._partial.unlink(missing_ok=True)

    def _create(self, steps: Mapping[str, np.ndarray], once: Mapping[str, np.ndarray]) -> None:
        self._partial.parent.mkdir(parents=True, exist_ok=True)
        file = h5py.File(self._partial, "w", libver="latest", rdcc_nbytes=0)
        file.attrs["arcgym_recording"] = FORMAT
        file[f"settings/{self._provenance.get('settings')}"] = json.dumps(self._settings)
        group = file.create_group("data/demo_0")
        task = str(self._provenance.get("task"))
        file["data"].attrs["env_args"] = json.dumps({"env_name": task, "type": "arcgym", "env_kwargs": {}})
        group.attrs["provenance"] = json.dumps(self._provenance)
        for name, value in once.items():
            _once(group, name, value)
        for name, value in steps.items():
            self._declare(group, name, value)
        file.swmr_mode = True
        self._file = file

    def _declare(self, group: h5py.Group, name: str, value: np.ndarray) -> None:
        """Make an empty dataset that grows by steps."""
        shape = value.shape[1:]
        group.create_dataset(
            name,
            shape=(0, *shape),
            maxshape=(None, *shape),
            chunks=(self._rows, *(max(size, 1) for size in shape)),
            dtype=value.dtype,
            compression="gzip",
            compression_opts=LEVEL,
            shuffle=value.dtype.itemsize > 1,
        )

    def _reopen(self) -> h5py.File:
        """Close the file and open it to change more than its length."""
        assert self._file is not None
        self._file.close()
        return h5py.File(self._partial, "r+", libver="latest", rdcc_nbytes=0)


def save_episode(episode: Episode, path: str | Path) -> Path:
    """Write an episode from memory; its values with ``info["length"]`` rows are those of steps.

    Args:
        episode: The episode, at least one step long.
        path: Name of the file; replaced where it exists.
    """
    length = episode.info["length"]
    steps = episode.steps or {name for name, value in episode.data.items() if value.shape[:1] == (length,)}
    writer = EpisodeWriter(Path(path), episode.provenance, episode.settings, rows=length)
    once = {name: value for name, value in episode.data.items() if name not in steps}
    writer.append({name: episode.data[name] for name in steps}, once)
    return writer.finish({}, {"success": False, **episode.info})


def allow_files(count: int) -> None:
    """Let this process have so many more files open than now.

    Raises:
        ValueError: If the system does not let it, with the number that it does.
    """
    wanted = count + 256  # libraries, devices and logs need some too
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        if hard != resource.RLIM_INFINITY and hard < wanted:
            raise ValueError(
                f"{count} worlds are to be recorded, each to a file of its own, but this system lets a program open "
                f"{hard} files: name {max(hard - 256, 1)} worlds or fewer in recorders.env_ids."
            )
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


def _once(group: h5py.Group, name: str, value: np.ndarray) -> None:
    packed = {"compression": "gzip", "compression_opts": LEVEL} if value.size > 64 else {}
    group.create_dataset(name, data=value, **packed)


def _shorten(item: Any, length: int) -> None:
    if isinstance(item, h5py.Dataset) and item.maxshape[:1] == (None,):
        item.resize(length, axis=0)
