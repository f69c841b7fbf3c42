# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Hashes of code, for files in the cache that depend on it."""

from __future__ import annotations

import hashlib
import importlib.util
from functools import cache
from pathlib import Path


@cache
def source_digest(*modules: str) -> str:
    """Return a hash of the source files of modules and of whole packages, 16 hexadecimal digits.

    Args:
        modules: Names such as ``arcgym.anatomy.stage``; nothing is imported but the packages around them.

    Raises:
        ModuleNotFoundError: If there is no such module.
    """
    digest = hashlib.sha256()
    for name in modules:
        spec = importlib.util.find_spec(name)
        if spec is None or spec.origin is None:
            raise ModuleNotFoundError(f"No module named {name!r}.")
        origin = Path(spec.origin)
        for file in sorted(origin.parent.rglob("*.py")) if origin.name == "__init__.py" else [origin]:
            digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()[:16]
