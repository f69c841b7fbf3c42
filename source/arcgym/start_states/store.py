# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Files of start states: beside a colon's stage, and in the cache folder."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from arcgym.sim.snapshot import SnapshotSet
from arcgym.start_states.key import StateKey
from arcgym.utils.paths import cache_dir

if TYPE_CHECKING:
    from arcgym.assets import Colon, Endoscope

DEFAULT_MATERIAL = "paper"
"""Tissue preset that states beside a colon are made in unless their file names another one."""
ALONE = ("clinical",)
"""Tissue presets in which those states are not at rest: without states of their own they have them made."""


def beside_colon(colon_path: Path, endoscope_path: Path, material: str = DEFAULT_MATERIAL) -> Path:
    """Return where states lie beside a colon's stage.

    ``snapshots/<endoscope>.npz``, or ``snapshots/<endoscope>_<material>.npz`` in another tissue than the default.
    """
    suffix = "" if material == DEFAULT_MATERIAL else f"_{material}"
    return colon_path.parent / "snapshots" / f"{endoscope_path.stem}{suffix}.npz"


def find_beside_colon(colon: Colon, endoscope: Endoscope, patient: int = 0) -> Path | None:
    """Return a patient's states made in the colon's tissue, else those made in the default one, else None."""
    own = colon.cfg.material
    materials = (own,) if own in ALONE else (own, DEFAULT_MATERIAL)
    stage = colon.patients[patient].path
    paths = (beside_colon(stage, endoscope.path, material) for material in materials)
    return next((path for path in paths if path.is_file()), None)


def in_cache(colon: Colon, endoscope: Endoscope, key: StateKey, patient: int = 0) -> Path:
    """Return where a patient's states lie in the cache: ``start_states/<colon>/<endoscope>-<material>-<hash>.npz``."""
    name = f"{endoscope.path.stem}-{colon.cfg.material}-{key.digest}.npz"
    return cache_dir() / "start_states" / colon.patients[patient].name / name


def outdated(path: Path, key: StateKey) -> list[str]:
    """Return which parts have changed since the newest file of the same names, empty if there is none.

    Args:
        path: File that is missing, from :func:`in_cache`.
        key: Its key.
    """
    others = path.parent.glob(f"{path.stem.rpartition('-')[0]}-*.npz") if path.parent.is_dir() else iter(())
    newest = max((other for other in others if other != path), key=lambda file: file.stat().st_mtime, default=None)
    states = None if newest is None else load(newest)
    return [] if states is None else key.changed(states.about.get("key", {}))


def load(path: Path) -> SnapshotSet | None:
    """Return the states in a file, None if it is missing or cannot be read."""
    try:
        return SnapshotSet.load(path) if path.is_file() else None
    except Exception:  # archive, LZMA, JSON and arrays each have errors of their own for damaged bytes
        return None


def describe(key: StateKey, arc: float, problem: str, speed: float) -> dict[str, object]:
    """Return what a file says about its states.

    Args:
        key: What they depend on.
        arc: Arc length that the tip has reached [m].
        problem: Why the drive ended before its goal; empty if it arrived.
        speed: Speed of the expert [m/s].
    """
    return {"key": dataclasses.asdict(key), "arc": arc, "problem": problem, "speed": speed}


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock beside ``path``, so that of several processes one makes the states and the others wait.

    Where files cannot be locked or written nothing is held.
    """
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(ImportError, OSError):
            import fcntl

            path.parent.mkdir(parents=True, exist_ok=True)
            file = stack.enter_context(open(path.with_suffix(".lock"), "w"))
            fcntl.flock(file, fcntl.LOCK_EX)
        yield
