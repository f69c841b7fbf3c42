# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Recorded episodes: one ``.npz`` file each, written whole or not at all; on request all of them in one HDF5 file."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

_INFO = "info"


@dataclass(frozen=True)
class Episode:
    """One recorded episode of T control steps."""

    data: dict[str, np.ndarray]
    """Arrays by name: values of steps, shape (T, ...), and values of the episode."""

    info: dict[str, Any]
    """``length`` T, ``step_dt`` [s], ``env_id``, ``complete``, ``success``, ``terminated``, ``time_out``, ``ended_by``
    (termination terms) and ``metrics`` by name."""

    def save(self, path: str | Path) -> None:
        """Write the file, whole or not at all."""
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        partial = path.with_suffix(".partial")
        with partial.open("wb") as file:
            np.savez_compressed(file, **{_INFO: np.array(json.dumps(self.info))}, **self.data)  # type: ignore[arg-type]
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, path)

    @staticmethod
    def load(path: str | Path) -> Episode:
        """Read a file written by :meth:`save`."""
        with np.load(path) as file:
            data = {name: file[name] for name in file.files}
        return Episode(info=json.loads(str(data.pop(_INFO))), data=data)


def episode_paths(folder: str | Path) -> list[Path]:
    """Return the episodes in a folder, in the order in which they were written."""
    return sorted(Path(folder).glob("*_[0-9]*.npz"))


def load_episodes(folder: str | Path) -> Iterator[Episode]:
    """Read the episodes in a folder one by one."""
    return (Episode.load(path) for path in episode_paths(folder))


def next_path(folder: str | Path, name: str) -> Path:
    """Return the first path ``<name>_000000.npz``, ``<name>_000001.npz``, ... after all that exist in a folder."""
    taken = [int(path.stem.rpartition("_")[2]) for path in Path(folder).glob(f"{name}_[0-9]*.npz")]
    return Path(folder) / f"{name}_{max(taken, default=-1) + 1:06d}.npz"


def export_hdf5(folder: str | Path, path: str | Path, env_args: dict[str, Any] | None = None) -> int:
    """Copy the episodes in a folder into one HDF5 file with the layout of Isaac Lab and robomimic.

    Episode k is the group ``data/demo_<k>`` with the attributes ``num_samples`` and ``success``; its names become
    groups and datasets. Needs h5py (``pip install arcgym[recorder]``).

    Args:
        folder: Where the episodes are.
        path: File to write; appears when it is complete.
        env_args: Facts about the environment, stored as JSON in an attribute.

    Returns:
        Number of episodes.
    """
    import h5py

    path, count, total = Path(path), 0, 0
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".partial")
    with h5py.File(partial, "w") as file:
        group = file.create_group("data")
        for count, episode in enumerate(load_episodes(folder), start=1):
            demo = group.create_group(f"demo_{count - 1}")
            demo.attrs["num_samples"] = episode.info["length"]
            demo.attrs["success"] = bool(episode.info["success"])
            demo.attrs["info"] = json.dumps(episode.info)
            for name, value in episode.data.items():
                demo.create_dataset(name, data=value, compression="gzip" if value.ndim else None)
            total += episode.info["length"]
        group.attrs["total"] = total
        group.attrs["env_args"] = json.dumps(env_args or {})
    os.replace(partial, path)
    return count
