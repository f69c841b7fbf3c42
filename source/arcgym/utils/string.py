# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Names: callables written as text, regular expressions over names, and hints for misspelt ones."""

from __future__ import annotations

import difflib
import importlib
import re
from collections.abc import Iterable, Sequence
from typing import Any


def did_you_mean(name: str, choices: Iterable[str]) -> str:
    """Return a sentence that offers the closest of ``choices``, then lists them all."""
    choices = sorted(choices)
    if not choices:
        return "Nothing is available here."
    return f"{nearest(name, choices)}Available: {', '.join(choices)}."


def nearest(name: str, choices: Iterable[str]) -> str:
    """Return ``Did you mean 'this' or 'that'? `` with the closest of ``choices``, or nothing where none is close."""
    close = difflib.get_close_matches(name, sorted(choices), n=3, cutoff=0.6)
    return f"Did you mean {' or '.join(repr(match) for match in close)}? " if close else ""


def callable_name(value: Any) -> str:
    """Return ``"module:qualified.name"`` of a function or class."""
    return f"{value.__module__}:{value.__qualname__}"


def resolve_callable(name: str) -> Any:
    """Import what ``"module:attribute"`` names.

    Args:
        name: Module path, a colon, and an attribute path inside the module, e.g. ``"arcgym.envs.mdp:time_out"``.

    Returns:
        The function or class.

    Raises:
        ValueError: If the text has another form, the module or the attribute does not exist, or it is not callable.
    """
    module_name, separator, attribute = name.partition(":")
    if not (module_name and separator and attribute):
        raise ValueError(f"'{name}' does not name a callable: expected 'module:attribute'.")
    try:
        value: Any = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        raise ValueError(f"Cannot resolve '{name}': {error}.") from error
    for part in attribute.split("."):
        if not hasattr(value, part):
            raise ValueError(f"Cannot resolve '{name}': no attribute '{part}'. {did_you_mean(part, _public(value))}")
        value = getattr(value, part)
    if not callable(value):
        raise ValueError(f"'{name}' is of type {type(value).__name__}, expected a callable.")
    return value


def resolve_matching_names(
    patterns: str | Sequence[str], names: Sequence[str], preserve_order: bool = False
) -> tuple[list[int], list[str]]:
    """Find the names that regular expressions match in full.

    Args:
        patterns: One expression or several.
        names: Names to search.
        preserve_order: Return matches in the order of ``patterns`` instead of the order of ``names``.

    Returns:
        Indices into ``names`` and the names themselves, each name once.

    Raises:
        ValueError: If an expression matches nothing.
    """
    patterns = [patterns] if isinstance(patterns, str) else list(patterns)
    found: list[int] = []
    for pattern in patterns:
        matches = [index for index, name in enumerate(names) if re.fullmatch(pattern, name)]
        if not matches:
            raise ValueError(f"'{pattern}' matches no name. {did_you_mean(pattern, names)}")
        found += [index for index in matches if index not in found]
    indices = found if preserve_order else sorted(found)
    return indices, [names[index] for index in indices]


def _public(value: Any) -> list[str]:
    return [name for name in dir(value) if not name.startswith("_")]
