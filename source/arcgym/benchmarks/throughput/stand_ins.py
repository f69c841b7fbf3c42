# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Patients that stand in for a population: one colon, bent a little differently each time."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.anatomy import ColonStage, read_colon, write_colon
from arcgym.assets.patient_cache import stage_content
from arcgym.utils.paths import cache_dir

AMPLITUDE = 3.0e-4
"""Largest displacement along each axis [m]: little enough that start states of the colon still suit."""
WAVELENGTH = 0.1, 0.2
"""Shortest and longest wavelength of the displacement [m]."""
VERSION = 1
"""Raise it when stand-ins change."""


def stand_ins(stage: Path, count: int) -> list[Path]:
    """Return stages of as many patients, the colon itself first; missing ones are written into the cache folder.

    All that a batch of patients costs is that of real ones: each has its own wall, skin and textures in memory.

    Args:
        stage: Stage of the colon.
        count: Number of patients.
    """
    folder = cache_dir() / "stand_ins" / f"{stage_content(stage)[:16]}-{VERSION}"
    others = [folder / f"{number:04d}" / "colon.usda" for number in range(1, count)]
    missing = [path for path in others if not path.is_file()]
    if missing:
        colon = read_colon(stage)
        with ThreadPoolExecutor() as pool:
            list(pool.map(lambda path: _write(colon, path), missing))
    return [stage, *others]


def displaced(points: np.ndarray, number: int) -> np.ndarray:
    """Return points moved as in a stand-in, in [m], shape (n, 3), of the same type."""
    rng = np.random.default_rng(number)
    wave = rng.normal(size=(3, 3))
    wave *= 2.0 * np.pi / rng.uniform(*WAVELENGTH, size=(3, 1)) / np.linalg.norm(wave, axis=1, keepdims=True)
    shift = AMPLITUDE * np.sin(points @ wave.T + rng.uniform(0.0, 2.0 * np.pi, 3))
    return (points + shift).astype(points.dtype)


def moved_states(states: Any, rests: Sequence[np.ndarray], marks: Sequence[str]) -> list[Any]:
    """Return the states of a colon as those of its stand-ins: their walls are displaced by as much as at rest.

    Args:
        states: Start states of the colon, a :class:`arcgym.sim.SnapshotSet`.
        rests: Rest positions of the wall of every patient [m], shape (V, 3), the colon's first.
        marks: Fingerprint of every patient.
    """
    return [
        replace(
            states,
            fingerprint=mark,
            snapshots=tuple(
                replace(one, arrays={**one.arrays, "nodal_pos": one.arrays["nodal_pos"] + (rest - rests[0])})
                for one in states.snapshots
            ),
        )
        for rest, mark in zip(rests, marks, strict=True)
    ]


def _displaced_layers(points: np.ndarray, number: int) -> np.ndarray:
    """Move both layers of a wall as its inner one: it stays as thick."""
    inner = points[: len(points) // 2]
    return points + np.tile(displaced(inner, number) - inner, (2, 1))


def _write(colon: ColonStage, path: Path) -> None:
    """Write a stand-in, its folder whole or not at all; the fine surface is the coarse one."""
    number = int(path.parent.name)
    proxy, contact = colon.visual_proxy, colon.contact
    proxy = replace(proxy, points=displaced(proxy.points, number))
    stage = replace(
        colon,
        wall=replace(colon.wall, points=_displaced_layers(colon.wall.points, number)),
        visual=proxy,
        visual_proxy=proxy,
        centerline=replace(colon.centerline, points=displaced(colon.centerline.points, number)),
        contact=None if contact is None else replace(contact, points=displaced(contact.points, number)),
    )
    path.parent.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent.parent, prefix=".making-") as folder:
        made = Path(folder) / "colon"
        write_colon(stage, made / "colon.usda")
        for texture in (stage.albedo_texture, stage.detail_texture):
            with (made / texture.name).open("ab") as file:
                file.write(f"{number:08d}".encode())  # after the picture's end: other content, same picture
        try:
            os.rename(made, path.parent)
        except OSError:
            if not path.is_file():  # else another process, which makes the same one, was first
                raise
