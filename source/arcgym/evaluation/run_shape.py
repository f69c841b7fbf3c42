# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Shape of ``run.json``, which people may have written into. Loads neither torch nor Warp."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def _is_changes(entry: Any) -> bool:
    pairs = [pair for fields in entry.values() if isinstance(fields, dict) for pair in fields.values()]
    return all(isinstance(fields, dict) for fields in entry.values()) and all(
        isinstance(pair, list) and len(pair) == 2 for pair in pairs
    )


def _is_inputs(entry: Any) -> bool:
    return all(
        isinstance(one, dict) and isinstance(one.get("sees"), list) and isinstance(one.get("simulator_depth"), bool)
        for one in entry.values()
    )


def _is_positive(entry: Any) -> bool:
    return all(isinstance(number, int | float) and number > 0 for number in entry.values())


def _is_counts(entry: Any) -> bool:
    return all(isinstance(count, int) and count > 0 for count in entry.values())


def _is_any(entry: Any) -> bool:
    return True


SHAPES: dict[str, tuple[type, Callable[[Any], bool], str]] = {
    "overrides": (list, _is_any, "a list of texts"),
    "checkpoint": (list, _is_any, "a list of paths"),
    "checkpoint_sha256": (list, _is_any, "a list of hashes"),
    "trained_on": (list, _is_any, "a list, an entry a checkpoint"),
    "training": (list, _is_any, "a list, an entry a checkpoint"),
    "versions": (dict, _is_any, "versions by name"),
    "changes": (dict, _is_changes, "registered and used value by field, by task"),
    "physics_hz": (dict, _is_positive, "physics steps a second by task"),
    "scope_length": (dict, _is_positive, "length of the scope by task [m]"),
    "stuck_after_s": (dict, _is_positive, "time without progress after which an episode ended by task [s]"),
    "dropped_contacts": (dict, _is_counts, "contacts by task"),
    "inputs": (dict, _is_inputs, "'sees' and 'simulator_depth' by task"),
}
"""Type of entries, a test of what is in them, and what they should be."""


def fault(run: Any) -> str | None:
    """Return what is wrong with the shape of a run, None if nothing is. Entries may be missing."""
    if not isinstance(run, dict):
        return f"it holds a {type(run).__name__}, expected entries by name"
    for name, (kind, fits, expected) in SHAPES.items():
        if name in run and not (isinstance(run[name], kind) and fits(run[name])):
            return f"{name} is {str(run[name])[:60]!r}, expected {expected}"
    return None
