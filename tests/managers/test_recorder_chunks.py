# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Chunks that are packed outside of HDF5 are what HDF5 itself would have stored."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from arcgym.managers import Episode
from arcgym.managers.recorder_chunks import LEAST_BYTES, pack, pack_together
from arcgym.managers.recorder_writer import EpisodeWriter

ROWS = 4


def values(dtype: str, count: int) -> np.ndarray:
    """Pictures that differ, of about 0.1 MB a chunk."""
    return (np.arange(count * 128 * 256).reshape(count, 128, 256) % 977).astype(dtype)


@pytest.mark.parametrize("dtype", ["uint8", "int8", "uint16", "float32"])
def test_a_chunk_is_the_one_of_hdf5(dtype, tmp_path) -> None:
    given = values(dtype, ROWS)
    with h5py.File(tmp_path / "plain.hdf5", "w") as file:
        packing = {"compression": "gzip", "compression_opts": 1, "shuffle": given.itemsize > 1}
        stored = file.create_dataset("x", data=given, chunks=given.shape, **packing)
        _, expected = stored.id.read_direct_chunk((0, 0, 0))
    assert pack(given, ROWS) == expected


def test_only_large_arrays_are_packed() -> None:
    small, large = np.zeros((ROWS, 3)), values("uint8", ROWS)
    assert small.nbytes < LEAST_BYTES <= large.nbytes
    assert pack_together([{"a": small, "b": large}, {}], ROWS) == [{"b": pack(large, ROWS)}, {}]


@pytest.mark.parametrize("counts", [(4, 4), (4, 2), (4, 4, 1)])
def test_packed_steps_are_read_again_and_can_be_read_meanwhile(counts, tmp_path) -> None:
    given = {"rgb": values("uint8", sum(counts)), "depth": values("uint16", sum(counts))}
    writer, there = EpisodeWriter(tmp_path / "episode_000000.hdf5", {}, {}, ROWS), 0
    for count in counts:
        steps = {name: value[there : there + count] for name, value in given.items()}
        assert writer.begins_chunk
        writer.append(steps, {}, pack_together([steps], ROWS)[0])
        there += count
        assert_read(next(tmp_path.glob("*.partial.hdf5")), given, there)
    writer.finish({}, {"success": False, "length": there})
    assert_read(tmp_path / "episode_000000.hdf5", given, there)


def test_steps_after_an_undo_within_a_chunk_are_written_by_hdf5(tmp_path) -> None:
    given = values("uint16", 9)
    writer = EpisodeWriter(tmp_path / "episode_000000.hdf5", {}, {}, ROWS)
    writer.append({"depth": given[:ROWS]}, {}, {"depth": pack(given[:ROWS], ROWS)})
    writer.shorten(3)
    assert not writer.begins_chunk
    writer.append({"depth": given[5:]}, {})
    path = writer.finish({}, {"success": False, "length": 7})
    assert_read(path, {"depth": np.r_[given[:3], given[5:]]}, 7)


def assert_read(path: Path, given: dict[str, np.ndarray], length: int) -> None:
    """Check that a file holds the first so many steps."""
    read = Episode.load(path)
    for name, value in given.items():
        np.testing.assert_array_equal(read.data[name], value[:length])
