# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Several episodes in one file."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import h5py

from arcgym.managers.recorder_files import FORMAT, PARTIAL, episode_paths, open_recording


def export_hdf5(folder: str | Path, path: str | Path) -> int:
    """Copy the finished episodes in a folder into one file, as :func:`join` does, and return their number."""
    return join(episode_paths(folder), path)


def join(sources: Sequence[Path], path: str | Path, only_successes: bool = False) -> int:
    """Copy the episodes of several files into one: episode k is the group ``data/demo_<k>``.

    Args:
        sources: The files.
        path: File to write; appears when it is complete.
        only_successes: Whether episodes that did not reach their goal are left out.

    Returns:
        Number of episodes.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.stem + PARTIAL)
    try:
        count = _copy(sources, partial, only_successes)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise
    os.replace(partial, path)
    return count


def _copy(sources: Sequence[Path], path: Path, only_successes: bool) -> int:
    count, total = 0, 0
    with h5py.File(path, "w", libver="latest") as file:
        file.attrs["arcgym_recording"] = FORMAT
        group = file.create_group("data")
        for one in sources:
            with open_recording(one) as source:
                for name, settings in source.get("settings", {}).items():
                    if f"settings/{name}" not in file:
                        file[f"settings/{name}"] = settings[()]
                for name, value in source["data"].attrs.items():
                    group.attrs[name] = value
                for demo in source["data"].values():
                    if only_successes and not demo.attrs["success"]:
                        continue
                    source.copy(demo, group, f"demo_{count}")
                    total += int(demo.attrs["num_samples"])
                    count += 1
        group.attrs["total"] = total
    return count
