# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Which stages a configuration asks for: one, a list, a folder, or a split of a population."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from arcgym.utils.paths import assets_dir, resolve_asset
from arcgym.utils.populations import population_stages
from arcgym.utils.string import did_you_mean

STAGE_NAMES = ("colon.usda", "colon.usdc", "colon.usd", "colon.usdz")
"""Names of stage files in the folders of patients, the first that is there."""


def find_stages(usd_path: str | Sequence[str], count: int | None = None) -> list[Path]:
    """Return the stages that a configuration names.

    Args:
        usd_path: A stage, a folder of folders with a stage each, ``name:split`` of a population, ``population:20000``
            for one of its patients by seed (``population:20000*0.8`` with less gas), or a list of these.
        count: How many of the stages to take, from the first; None for all.

    Raises:
        ValueError: If there is no such population or split, a folder has no stages, a stage comes twice, or there are
            fewer stages than asked for.
    """
    entries = _joined([usd_path] if isinstance(usd_path, str) else list(usd_path))
    paths: list[Path] = []
    for entry in entries:
        if count is None or len(paths) < count:  # patients of a population that nobody takes would be made
            paths += _stages_of(entry, None if count is None else count - len(paths))
    if not paths:
        raise ValueError("ColonCfg.usd_path is an empty list, expected at least one stage.")
    if count is not None and len(paths) < count:
        raise ValueError(f"ColonCfg.num_patients is {count}, but {usd_path} has {len(paths)} patients.")
    paths = paths[:count]
    twice = next((path for path in paths if paths.count(path) > 1), None)
    if twice is not None:
        raise ValueError(f"ColonCfg.usd_path names {twice} twice, expected each stage once.")
    return paths


def named_colon(name: str) -> str:
    """Return the ``usd_path`` that a word on a command line means.

    Args:
        name: A colon that comes along, such as ``colon_1``, or all that :func:`find_stages` takes.

    Raises:
        ValueError: If there is no such file or folder, with the nearest of the colons that come along.
    """
    for path in (name, f"{name}/{STAGE_NAMES[0]}"):
        if resolve_asset(path).is_file():
            return path
    if ":" in name or resolve_asset(name).is_dir():
        return name
    known = sorted(path.parent.name for path in assets_dir().glob(f"*/{STAGE_NAMES[0]}"))
    raise ValueError(f"There is no colon '{name}', which is no stage file. {did_you_mean(name, known)}")


def _joined(entries: list[str]) -> list[str]:
    """Return the entries with neighbors that are single patients of a population made one: they are made together."""
    joined: list[str] = []
    single = ""
    for entry in entries:
        population, _, name = entry.partition(":")
        is_single = name[:1].isdigit()
        if is_single and population == single:
            joined[-1] = f"{joined[-1]},{name}"
        else:
            joined.append(entry)
        single = population if is_single else ""
    return joined


def _stages_of(entry: str, count: int | None) -> Sequence[Path]:
    population, colon, split = entry.partition(":")
    if colon and len(population) > 1 and not _exists(entry):
        return population_stages(population, split, count)
    path = resolve_asset(entry)
    return _of_folder(path) if path.is_dir() else [path]


def _exists(path: str) -> bool:
    """Return whether there is such a file; no file system has names as long as those of 50 patients by seed."""
    try:
        return Path(path).exists()
    except OSError:
        return False


def _of_folder(folder: Path) -> Sequence[Path]:
    """Return the stage in a folder, or those in the folders in it, sorted by name."""
    places = [folder] if _stage_in(folder) else sorted(place for place in folder.iterdir() if place.is_dir())
    found = [stage for stage in map(_stage_in, places) if stage is not None]
    if not found:
        raise ValueError(f"ColonCfg.usd_path: no stages in {folder}, expected a colon.usda in it or in its folders.")
    return found


def _stage_in(folder: Path) -> Path | None:
    return next((folder / name for name in STAGE_NAMES if (folder / name).is_file()), None)
