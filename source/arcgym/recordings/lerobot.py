# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Recordings as a LeRobot data set of version 3.0: parquet tables, videos and their descriptions."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from arcgym.recordings.lerobot_stats import FeatureStats, merged
from arcgym.recordings.samples import NO_EPISODE, Samples
from arcgym.utils.errors import UsageError
from arcgym.viewers.video import VideoRecorder

VERSION = "v3.0"
"""Version of the layout."""
CHUNK = 1000
"""Files in a folder."""
VIDEO = "observation.images.endoscope"
"""Name of the pictures."""
COUNTERS = {"timestamp": "float32"} | dict.fromkeys(("frame_index", "episode_index", "index", "task_index"), "int64")
"""Columns that every data set has, with their types."""


class LeRobotWriter:
    """Writes one file of frames and one video an episode, so that each is whole when the next begins."""

    def __init__(self, folder: Path) -> None:
        """Begin a data set in a new folder.

        Raises:
            UsageError: If something is there.
        """
        if folder.exists():
            raise UsageError(f"{folder} exists; name a folder that does not.")
        self._folder = folder
        self._tasks: dict[str, int] = {}
        self._episodes: list[dict[str, Any]] = []
        self._stats: list[dict[str, FeatureStats]] = []
        self._frames = 0
        self._features: dict[str, Any] = {}
        self._fps = 0

    def add(self, one: Samples) -> None:
        """Write an episode.

        Raises:
            UsageError: If its values, pictures or rate are not those of the first episode.
        """
        number = len(self._episodes)
        features, fps = _features(one), round(1.0 / one.step_dt)
        if not self._episodes:
            self._features, self._fps = features, fps
        if features != self._features or fps != self._fps:
            raise UsageError(f"Episode {number} differs from the first in values, size of pictures or rate.")
        task = self._tasks.setdefault(one.task, len(self._tasks))
        columns = self._columns(one, number, task)
        chunk, file = divmod(number, CHUNK)
        place = f"chunk-{chunk:03d}/file-{file:03d}"
        self._table(columns, self._folder / "data" / f"{place}.parquet")
        stats = {name: FeatureStats.of(np.asarray(value)) for name, value in columns.items()}
        row: dict[str, Any] = {
            "episode_index": number,
            "tasks": [one.task],
            "length": len(one),
            "data/chunk_index": chunk,
            "data/file_index": file,
            "dataset_from_index": self._frames,
            "dataset_to_index": self._frames + len(one),
        }
        if one.image is not None:
            self._video(one.image, self._folder / "videos" / VIDEO / f"{place}.mp4")
            stats[VIDEO] = FeatureStats.of_images(one.image)
            end = len(one) / self._fps
            timing = {"chunk_index": chunk, "file_index": file, "from_timestamp": 0.0, "to_timestamp": end}
            row |= {f"videos/{VIDEO}/{name}": value for name, value in timing.items()}
        self._frames += len(one)
        self._episodes.append(row)
        self._stats.append(stats)

    def finish(self) -> int:
        """Write the descriptions; return the number of episodes.

        Raises:
            UsageError: If there is no episode.
        """
        if not self._episodes:
            raise UsageError(NO_EPISODE)
        meta = self._folder / "meta"
        rows = [
            row | {"meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0} | _flat(stats)
            for row, stats in zip(self._episodes, self._stats, strict=True)
        ]
        _write_table(pa.Table.from_pylist(rows), meta / "episodes" / "chunk-000" / "file-000.parquet")
        _write_table(_task_table(self._tasks), meta / "tasks.parquet")
        total = {name: one.plain() for name, one in merged(self._stats).items()}
        (meta / "stats.json").write_text(json.dumps(total, indent=1))
        (meta / "info.json").write_text(json.dumps(self._info(), indent=1))
        return len(self._episodes)

    def _columns(self, one: Samples, number: int, task: int) -> dict[str, np.ndarray]:
        count = len(one)
        frame, done = np.arange(count), np.zeros(count, bool)
        done[-1] = True
        return {
            "action": one.action,
            "observation.state": one.state,
            "next.reward": one.reward,
            "next.done": done,
            "next.success": done & one.success,
            "timestamp": (frame / self._fps).astype(np.float32),
            "frame_index": frame,
            "episode_index": np.full(count, number),
            "index": self._frames + frame,
            "task_index": np.full(count, task),
        }

    def _table(self, columns: dict[str, np.ndarray], path: Path) -> None:
        arrays = {}
        for name, value in columns.items():
            kind = pa.from_numpy_dtype(self._features[name]["dtype"])
            flat = pa.array(value.astype(self._features[name]["dtype"]).ravel(), type=kind)
            arrays[name] = pa.FixedSizeListArray.from_arrays(flat, value.shape[1]) if value.ndim == 2 else flat
        _write_table(pa.table(arrays), path)

    def _video(self, images: np.ndarray, path: Path) -> None:
        with VideoRecorder(path, self._fps, quality=9.0) as video:
            for image in images:
                video.write(image)

    def _info(self) -> dict[str, Any]:
        has_video = VIDEO in self._features
        return {
            "codebase_version": VERSION,
            "robot_type": "arcgym",
            "total_episodes": len(self._episodes),
            "total_frames": self._frames,
            "total_tasks": len(self._tasks),
            "chunks_size": CHUNK,
            "data_files_size_in_mb": 100,
            "video_files_size_in_mb": 200,
            "fps": self._fps,
            "splits": {"train": f"0:{len(self._episodes)}"},
            "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
            "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4" if has_video else None,
            "features": self._features,
        }


def write_lerobot(samples: Iterable[Samples], folder: Path) -> int:
    """Write a data set into a new folder, and return the number of its episodes.

    Raises:
        UsageError: If the folder exists, or there is no episode; nothing is then left behind.
    """
    writer = LeRobotWriter(folder)
    try:
        for one in samples:
            writer.add(one)
        return writer.finish()
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _features(one: Samples) -> dict[str, Any]:
    features: dict[str, Any] = {
        "action": _feature("float32", one.action.shape[1:], [f"action_{k}" for k in range(one.action.shape[1])]),
        "observation.state": _feature("float32", one.state.shape[1:], list(one.names)),
        "next.reward": _feature("float32"),
        "next.done": _feature("bool"),
        "next.success": _feature("bool"),
    }
    features |= {name: _feature(kind) for name, kind in COUNTERS.items()}
    if one.image is not None:
        height, width, _ = one.image.shape[1:]
        info = {"video.height": height, "video.width": width, "video.codec": "h264", "video.pix_fmt": "yuv420p"}
        info |= {"video.fps": round(1.0 / one.step_dt), "video.channels": 3, "video.is_depth_map": False}
        info["has_audio"] = False
        features[VIDEO] = _feature("video", one.image.shape[1:], ["height", "width", "channels"]) | {"info": info}
    return features


def _feature(kind: str, shape: tuple[int, ...] = (1,), names: list[str] | None = None) -> dict[str, Any]:
    return {"dtype": kind, "shape": list(shape), "names": names}


def _flat(stats: dict[str, FeatureStats]) -> dict[str, Any]:
    return {f"stats/{name}/{key}": value for name, one in stats.items() for key, value in one.plain().items()}


def _task_table(tasks: dict[str, int]) -> pa.Table:
    """Return a table that pandas reads with the tasks as its index."""
    plain: dict[str, Any] = {"metadata": None, "name": None, "field_name": None}
    text = plain | {"pandas_type": "unicode", "numpy_type": "object"}
    index = text | {"field_name": "__index_level_0__"}
    column = plain | {"pandas_type": "int64", "numpy_type": "int64", "name": "task_index", "field_name": "task_index"}
    about = {"index_columns": ["__index_level_0__"], "column_indexes": [text], "columns": [column, index]}
    made_by = {"creator": {"library": "pyarrow", "version": pa.__version__}, "pandas_version": "2.0.0"}
    table = pa.table({"task_index": pa.array(list(tasks.values()), pa.int64()), "__index_level_0__": list(tasks)})
    return table.replace_schema_metadata({"pandas": json.dumps(about | made_by)})


def _write_table(table: pa.Table, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, path)
