# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Patients read from compact files in the cache folder: a stage takes ten times as long, for its fine surface."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from pxr import UsdUtils

from arcgym.assets.patient import Patient, read_patient
from arcgym.utils.array_files import load_arrays, save_arrays
from arcgym.utils.paths import cache_dir
from arcgym.utils.progress import report
from arcgym.utils.source_digest import source_digest

T = TypeVar("T")

SUFFIXES = (".usd", ".usda", ".usdc", ".usdz", ".png", ".jpg", ".jpeg")
"""Files of a stage's folder that belong to it."""
CODE = ("arcgym.anatomy.stage", "arcgym.anatomy.shell", "arcgym.anatomy.measures", "arcgym.assets.patient")
"""Code that decides what is read of a stage."""


def load_patients(paths: Sequence[Path], thickness: float | None, shell: bool) -> tuple[Patient, ...]:
    """Read patients, several at a time; the stages of several are kept in the cache folder.

    Args:
        paths: Stage files.
        thickness: Thickness of the wall [m]; None takes the stages'.
        shell: Whether the walls are to be shells, or the stages' tetrahedra.

    Raises:
        StageError: If a stage cannot be used.
    """
    if len(paths) == 1:
        return (read_patient(paths[0], thickness, shell),)
    report(f"reading {len(paths)} patients")
    with ThreadPoolExecutor() as pool:
        return tuple(pool.map(lambda path: _load(path, thickness, shell), paths))


def cached(kind: str, key: Sequence[Any], name: str, make: Callable[[], T]) -> T:
    """Return what a file of the cache holds; it is made and written if there is none.

    Args:
        kind: Kind of content; files of one kind lie in one folder.
        key: All that the content depends on, as texts and numbers.
        name: Begin of the file's name, for people.
        make: Makes the content, as :func:`arcgym.utils.array_files.save_arrays` can write it.
    """
    digest = hashlib.sha256(repr(list(key)).encode()).hexdigest()[:20]
    path = cache_dir() / kind / f"{name}-{digest}.npz"
    found: T | None = load_arrays(path)
    if found is None:
        found = make()
        with contextlib.suppress(OSError):  # a folder that cannot be written costs the next run its time
            save_arrays(found, path)
    return found


def _load(path: Path, thickness: float | None, shell: bool) -> Patient:
    content = stage_content(path)
    if not content:
        return read_patient(path, thickness, shell)
    path = path.resolve()  # what is kept names the files themselves: a link to them may be gone tomorrow
    key = (content, str(path), thickness, shell, source_digest(*CODE))
    name = path.parent.name
    return replace(cached("patients", key, name, lambda: read_patient(path, thickness, shell)), content=content)


def stage_content(path: Path) -> str:
    """Return a hash of a stage with its layers and textures, empty if some lie elsewhere or the file is missing."""
    folder = path.resolve().parent
    if not path.is_file() or not _is_whole(path, folder):
        return ""
    digest = hashlib.sha256()
    for file in sorted(file for file in folder.iterdir() if file.suffix.lower() in SUFFIXES):
        digest.update(file.name.encode() + hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()


def _is_whole(path: Path, folder: Path) -> bool:
    """Return whether all files that a stage names lie in its folder."""
    layers, assets, missing = UsdUtils.ComputeAllDependencies(str(path))
    files = [*(layer.realPath for layer in layers), *assets]
    return not missing and all(Path(file).resolve().parent == folder for file in files)
