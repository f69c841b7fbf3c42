# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Dataclasses of arrays in ``.npz`` files."""

from __future__ import annotations

import dataclasses
import importlib
import json
import os
import threading
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

_SKELETON = "skeleton"
_PACKAGE = "arcgym."
_READING = threading.Lock()
"""One file at a time: NumPy parses its headers as Python, which Python 3.11 cannot do in two threads at once
(github.com/python/cpython/issues/106905)."""


def save_arrays(value: Any, path: Path) -> None:
    """Write a value to an uncompressed ``.npz`` file, whole or not at all.

    Args:
        value: Dataclasses of this package, dicts, lists, tuples, paths, texts, numbers, None and arrays, nested.
        path: The file.

    Raises:
        TypeError: If something else is in it.
        OSError: If the file cannot be written.
    """
    arrays: list[np.ndarray] = []
    skeleton = _take_apart(value, arrays)
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.stem}.{os.getpid()}.{threading.get_ident()}.partial.npz")
    try:
        np.savez(partial, **{_SKELETON: json.dumps(skeleton)}, **{str(k): array for k, array in enumerate(arrays)})  # type: ignore[arg-type]
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def load_arrays(path: Path) -> Any:
    """Return the value in a file written by :func:`save_arrays`; None if it is missing or cannot be read."""
    try:
        with _READING, np.load(path) as file:
            return _put_together(json.loads(str(file[_SKELETON])), file)
    except (OSError, EOFError, ValueError, KeyError, TypeError, AttributeError, ImportError, zipfile.BadZipFile):
        return None


def _take_apart(value: Any, arrays: list[np.ndarray]) -> Any:
    """Return the value as JSON, in which arrays are numbers; they are added to ``arrays``."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.ndarray):
        arrays.append(value)
        return {"array": len(arrays) - 1}
    if isinstance(value, Path):
        return {"path": str(value)}
    if isinstance(value, (list, tuple)):
        return {type(value).__name__: [_take_apart(entry, arrays) for entry in value]}
    if isinstance(value, dict):
        return {"dict": {name: _take_apart(entry, arrays) for name, entry in value.items()}}
    if dataclasses.is_dataclass(value) and not isinstance(value, type) and type(value).__module__.startswith(_PACKAGE):
        fields = {field.name: _take_apart(getattr(value, field.name), arrays) for field in dataclasses.fields(value)}
        return {"class": f"{type(value).__module__}:{type(value).__qualname__}", "fields": fields}
    raise TypeError(f"A {type(value).__name__} cannot be written to an array file.")


def _put_together(part: Any, file: Any) -> Any:
    if not isinstance(part, dict):
        return part
    if "array" in part:
        return file[str(part["array"])]
    if "path" in part:
        return Path(part["path"])
    if "list" in part or "tuple" in part:
        entries = [_put_together(entry, file) for entry in next(iter(part.values()))]
        return entries if "list" in part else tuple(entries)
    if "dict" in part:
        return {name: _put_together(entry, file) for name, entry in part["dict"].items()}
    module, _, name = part["class"].partition(":")
    if not module.startswith(_PACKAGE):
        raise ValueError(f"{module} is no module of this package.")
    cls = getattr(importlib.import_module(module), name)
    return cls(**{field: _put_together(entry, file) for field, entry in part["fields"].items()})
