# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Read a colon's spec from YAML: the fields of :class:`ColonSpec`, all optional, over its defaults."""

from __future__ import annotations

import dataclasses
import typing
from pathlib import Path
from typing import Any

import yaml

from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.segments import SEGMENTS


class SpecError(ValueError):
    """A spec file cannot be used; the message names the value and why."""


def read_spec(path: str | Path) -> ColonSpec:
    """Read a spec file.

    Raises:
        SpecError: The file is not YAML, or a value is unknown, of the wrong type or out of range.
    """
    try:
        values = yaml.safe_load(Path(path).read_text())
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise SpecError(f"{path} cannot be read: {error}") from error
    try:
        return _build(ColonSpec(), {} if values is None else values, "")
    except ValueError as error:
        raise SpecError(f"{path}: {error}") from error


def _build(default: Any, values: Any, where: str) -> Any:
    """Return a copy of a config with the given values replaced."""
    if not isinstance(values, dict):
        raise ValueError(f"{where or 'spec'} is {values!r}; expected a mapping of fields.")
    types = typing.get_type_hints(type(default))
    unknown = [str(name) for name in values if name not in types]
    if unknown:
        raise ValueError(f"{where}{', '.join(unknown)} unknown; fields are {', '.join(types)}.")
    changes = {}
    for name, value in values.items():
        if name == "segments":
            changes[name] = _segments(default.segments, value)
        else:
            changes[name] = _convert(types[name], getattr(default, name), value, f"{where}{name}")
    return dataclasses.replace(default, **changes)


def _segments(default: dict, values: Any) -> dict:
    unknown = [str(name) for name in values if name not in SEGMENTS] if isinstance(values, dict) else [repr(values)]
    if unknown:
        raise ValueError(f"segments: {', '.join(unknown)} unknown; segments are {', '.join(SEGMENTS)}.")
    return default | {name: _build(default[name], value, f"segments.{name}.") for name, value in values.items()}


def _convert(kind: Any, default: Any, value: Any, where: str) -> Any:
    """Return the value as the type of its field."""
    parts = typing.get_args(kind)
    if typing.get_origin(kind) is tuple:
        if not isinstance(value, list) or (parts[-1] is not ... and len(value) != len(parts)):
            wanted = "any number of" if parts[-1] is ... else str(len(parts))
            raise ValueError(f"{where} is {value!r}; expected a list of {wanted} values.")
        return tuple(_convert(parts[0], None, item, f"{where}[{k}]") for k, item in enumerate(value))
    if parts:
        if value is None:
            return None
        kind = next(part for part in parts if part is not type(None))
    if dataclasses.is_dataclass(kind):
        return _build(default, value, f"{where}.") if default is not None else _make(kind, value, where)
    accepted = (int, float) if kind is float else kind
    if not isinstance(value, accepted) or (isinstance(value, bool) and kind is not bool):
        raise ValueError(f"{where} is {value!r}; expected {kind.__name__}.")
    return kind(value)


def _make(kind: Any, values: Any, where: str) -> Any:
    """Build an item of a list, such as a polyp."""
    if not isinstance(values, dict):
        raise ValueError(f"{where} is {values!r}; expected a mapping of fields.")
    types = typing.get_type_hints(kind)
    unknown = [str(name) for name in values if name not in types]
    required = [item.name for item in dataclasses.fields(kind) if item.default is dataclasses.MISSING]
    missing = [name for name in required if name not in values]
    if unknown or missing:
        raise ValueError(f"{where}: missing {missing}, unknown {unknown}; fields are {', '.join(types)}.")
    return kind(**{name: _convert(types[name], None, value, f"{where}.{name}") for name, value in values.items()})
