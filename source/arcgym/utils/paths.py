# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Folder of the assets."""

from __future__ import annotations

import os
import sys
from pathlib import Path

CACHE_ENV = "ARCGYM_CACHE"
"""Environment variable that names the cache folder; it wins over the user's."""
ASSETS_ENV = "ARCGYM_ASSETS"
"""Environment variable that names the assets folder; it wins over the folders of the package and the checkout."""

_PACKAGE = Path(__file__).resolve().parents[1]
_CHECKOUT = Path(__file__).resolve().parents[3]


def assets_dir() -> Path:
    """Return the folder of the USD assets, the one that holds ``endoscopes/`` and ``colon_1/``.

    Looked for in this order: the folder named by the environment variable ``ARCGYM_ASSETS``, ``data/usd`` of the
    installed package, ``assets/usd`` of the checkout.

    Raises:
        FileNotFoundError: If none of them is a folder. A set ``ARCGYM_ASSETS`` must be one: it is never skipped.
    """
    named = os.environ.get(ASSETS_ENV)
    places = [Path(named).expanduser()] if named else [_PACKAGE / "data" / "usd", _CHECKOUT / "assets" / "usd"]
    for place in places:
        if place.is_dir():
            return place
    tried = ", ".join(str(place) for place in places)
    raise FileNotFoundError(f"No assets folder. Tried: {tried}. Set {ASSETS_ENV} to the folder that has 'endoscopes/'.")


def cache_dir() -> Path:
    """Return the folder for what can be made again, which may not exist yet.

    It is the one that ``ARCGYM_CACHE`` names, else ``arcgym`` in the user's cache folder: ``$XDG_CACHE_HOME`` or
    ``~/.cache``, ``~/Library/Caches`` on macOS, ``%LOCALAPPDATA%`` on Windows.
    """
    named = os.environ.get(CACHE_ENV)
    if named:
        return Path(named).expanduser()
    home = Path.home()
    if sys.platform == "darwin":
        base = home / "Library" / "Caches"
    elif sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache")
    return base / "arcgym"


def resolve_asset(path: str | Path) -> Path:
    """Return `path` itself where it exists, from the working folder, or is absolute, else inside :func:`assets_dir`."""
    given = Path(path).expanduser()
    return given if given.is_absolute() or given.exists() else assets_dir() / given


def resolve_stage(path: str | Path) -> Path:
    """Return the stage of a colon that is named by its file, its folder, or as one that comes along, ``colon_1``."""
    found = resolve_asset(path)
    return found / "colon.usda" if (found / "colon.usda").is_file() else found


def portable_asset(path: str | Path) -> str:
    """Return how another machine finds an asset: the path inside :func:`assets_dir`, else the path itself."""
    place, given = assets_dir().resolve(), Path(path).resolve()
    return given.relative_to(place).as_posix() if given.is_relative_to(place) else str(path)
