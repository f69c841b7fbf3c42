# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Checks of an import's paths before anything is read or made."""

from __future__ import annotations

import json
import os
from pathlib import Path

from arcgym.anatomy.importing.errors import ImportArgumentError
from arcgym.anatomy.importing.formats import SURFACE_SUFFIXES, VOLUME_SUFFIXES

MADE_BY = "arcgym import-colon"
"""What ``made_by`` says in the report of an import."""

_REPORT = "report.json"
_OWN_FILES = {"colon.usda", "colon.usdc", _REPORT, "report.png", "preview.png", "snapshots"}
"""What an import, a preview and start states put into the folder, beside textures."""

_OWN_TEXTURES = {"mucosa_albedo.jpg", "mucosa_detail.png"}
"""The textures."""


def check_paths(path: Path, out: Path, overwrite: bool) -> None:
    """Check input and output.

    Args:
        path: Label volume or surface.
        out: Folder to make.
        overwrite: Whether a folder that exists may be replaced.

    Raises:
        ImportArgumentError: The input is no file of a known kind, or the folder cannot be made.
    """
    check_input(path)
    if out.exists():
        _check_replaceable(path, out, overwrite)
    parent = next(folder for folder in out.absolute().parents if folder.exists())
    if not parent.is_dir():
        raise ImportArgumentError(f"{out} cannot be made: {parent} is a file", "Pass a folder below another folder.")
    if not os.access(parent, os.W_OK | os.X_OK):
        raise ImportArgumentError(f"{out} cannot be made: {parent} is not writable", "Pass a folder elsewhere.")


def check_input(path: Path) -> None:
    """Check that an input is a file of a known kind.

    Raises:
        ImportArgumentError: It does not exist, is a folder, or its name has an unknown ending.
    """
    known = ", ".join(VOLUME_SUFFIXES + SURFACE_SUFFIXES)
    if path.is_dir():
        raise ImportArgumentError(f"{path} is a folder", f"Pass one file that ends in {known}.")
    if not path.is_file():
        raise ImportArgumentError(f"{path} does not exist", "Pass a label volume or a surface.")
    if not path.name.lower().endswith(VOLUME_SUFFIXES + SURFACE_SUFFIXES):
        raise ImportArgumentError(f"{path} is of no known kind", f"Pass a file that ends in {known}.")


def _check_replaceable(path: Path, out: Path, overwrite: bool) -> None:
    """Check that an existing folder may be deleted: asked for, empty or an import's and nothing else, not in use."""
    if not overwrite:
        raise ImportArgumentError(f"{out} exists", "Pass another folder, or --overwrite.")
    whole = out.resolve()
    if whole in path.resolve().parents or whole in (Path.cwd(), *Path.cwd().parents):
        raise ImportArgumentError(f"{out} is not replaced: it is in use", "Pass another folder.")
    if not out.is_dir() or out.is_symlink():
        raise ImportArgumentError(f"{out} is not replaced: it is no folder", "Pass another folder, or remove it.")
    names = sorted(entry.name for entry in out.iterdir())
    foreign = [name for name in names if name not in _OWN_FILES | _OWN_TEXTURES]
    if foreign:
        some = ", ".join(foreign[:3]) + (f" and {len(foreign) - 3} more" if len(foreign) > 3 else "")
        found = f"{out} is not replaced: {some} in it is not of an import"
        raise ImportArgumentError(found, "Pass another folder, or remove it.")
    if names and not made_by_import(out / _REPORT):
        found = f"{out} is not replaced: it is neither empty nor a folder made by an import"
        raise ImportArgumentError(found, "Pass another folder, or remove it.")


def made_by_import(report: Path) -> bool:
    """Return whether a report is there and was written by an import."""
    try:
        return json.loads(report.read_text()).get("made_by") == MADE_BY
    except (OSError, ValueError, AttributeError):
        return False
