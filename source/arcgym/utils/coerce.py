# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Values of configurations: their declared types, plain forms for files, and back."""

from __future__ import annotations

import copy
import dataclasses
import enum
import re
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin

from arcgym.utils.string import callable_name, did_you_mean, resolve_callable

_SLICE = re.compile(r"slice\((None|-?\d+), (None|-?\d+), (None|-?\d+)\)")


def is_config(value: Any) -> bool:
    """Return whether a value is an instance of a configuration class."""
    return dataclasses.is_dataclass(value) and not isinstance(value, type)


def is_missing(value: Any) -> bool:
    """Return whether a value is the mark of a field not yet set, or a pickled copy of it."""
    return isinstance(value, type(dataclasses.MISSING))


def field_types(cls: type) -> dict[str, Any]:
    """Return the declared type of every field; ``Any`` where a name is imported for type checkers only.

    Unlike :func:`typing.get_type_hints` it resolves names of classes nested in the class that uses them.
    """
    hints: dict[str, Any] = {}
    for base in reversed(cls.__mro__):
        module = sys.modules.get(base.__module__)
        for name, annotation in base.__dict__.get("__annotations__", {}).items():
            hints[name] = _evaluate(annotation, vars(module) if module else {}, dict(vars(base)))
    return hints


def to_plain(value: Any) -> Any:
    """Turn a value into dicts, lists, strings and numbers."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if is_config(value):
        return {name: to_plain(child) for name, child in vars(value).items()}
    if isinstance(value, dict):
        return {str(name): to_plain(child) for name, child in value.items()}
    if isinstance(value, (list, tuple, set)):
        return [to_plain(child) for child in value]
    if is_missing(value):
        return "MISSING"
    if isinstance(value, enum.Enum):
        return value.name
    if isinstance(value, (type, types.FunctionType, types.BuiltinFunctionType)):
        return callable_name(value)
    return value.tolist() if hasattr(value, "tolist") else str(value)


def from_dict(cfg: Any, data: dict[str, Any], path: str = "") -> None:
    """Write the values of nested dicts into ``cfg``, in place.

    Args:
        cfg: Configuration to change.
        data: As :func:`arcgym.utils.configclass.to_dict` returns it; entries may be left out.
        path: Where ``cfg`` sits in a larger configuration, for messages.

    Raises:
        ValueError: If a name is unknown, with the names that exist.
        TypeError: If a value does not fit its field.
    """
    hints = field_types(type(cfg))
    for name, value in data.items():
        here = f"{path}.{name}" if path else name
        if name not in vars(cfg):
            raise ValueError(f"{type(cfg).__name__} has no field '{here}'. {did_you_mean(name, vars(cfg))}")
        current = getattr(cfg, name)
        if is_config(current) and isinstance(value, dict):
            from_dict(current, value, here)
        else:
            setattr(cfg, name, coerce(value, hints.get(name, Any), current, here))


def coerce(value: Any, expected: Any, current: Any, path: str) -> Any:
    """Fit a plain value, from a command line or a file, to a field.

    Integers pass for floats, lists for tuples, dicts for configurations, ``"module:name"`` for callables, names for
    members of an enumeration and for presets of a configuration with ``from_name``; nothing else is converted.

    Args:
        value: What was given.
        expected: Declared type of the field; ``Any`` falls back to the type of ``current``.
        current: Value that the field holds now.
        path: Dotted name of the field, for messages.

    Returns:
        The value to store.

    Raises:
        TypeError: With the field, the expected type and what was given.
        ValueError: If a callable, an enumeration member or a nested field does not exist.
    """
    if value is None and (current is None or _may_be_none(expected) or _may_be_none(type(current))):
        return None
    if expected in (Any, object):
        if current is None or is_missing(current):
            return value
        expected = Callable if callable(current) and not is_config(current) else type(current)
    origin = get_origin(expected)
    if origin in (Union, types.UnionType):
        return _coerce_union(value, expected, current, path)
    if origin is Literal:
        return _coerce_literal(value, expected, path)
    kind = origin or expected
    if kind in (Callable, type):
        return _coerce_callable(value, expected, path)
    if not isinstance(kind, type):
        return value
    if isinstance(value, str) and issubclass(kind, enum.Enum):
        return _coerce_enum(value, kind, path)
    if kind in (tuple, list):
        return _coerce_sequence(value, expected, kind, current, path)
    if kind is dict:
        return _coerce_mapping(value, expected, current, path)
    if dataclasses.is_dataclass(kind) and isinstance(value, dict):
        return _build_config(value, kind, current, path)
    if isinstance(value, str) and hasattr(kind, "from_name"):
        return _named_config(value, kind, path)
    return _coerce_scalar(value, kind, expected, path)


def check_declared(cfg: Any, path: str = "") -> None:
    """Check that numbers, texts and ``Literal`` names in the fields of a configuration have their declared types.

    Args:
        cfg: Configuration; fields of other types, nested configurations among them, are left out.
        path: Where it sits in a larger configuration, for messages.

    Raises:
        TypeError: With the field, the expected type and what was given.
    """
    hints = field_types(type(cfg))
    for name, value in vars(cfg).items():
        expected = hints.get(name, Any)
        if _is_plain(expected):
            coerce(value, expected, value, f"{path}.{name}" if path else name)


def _is_plain(expected: Any) -> bool:
    """Return whether a type is made of numbers, texts and names alone."""
    origin = get_origin(expected)
    if origin is Literal:
        return True
    if origin in (Union, types.UnionType, tuple, list, dict):
        return all(_is_plain(part) for part in get_args(expected))
    return expected in (bool, int, float, str, None, type(None), Ellipsis)


def _evaluate(annotation: Any, module: dict[str, Any], scope: dict[str, Any]) -> Any:
    if not isinstance(annotation, str):
        return annotation
    try:
        return eval(annotation, module, scope)
    except (NameError, AttributeError, TypeError):
        return Any


def _may_be_none(expected: Any) -> bool:
    """Return whether a type is optional, or a configuration that declares ``can_be_none``."""
    return type(None) in (expected, *get_args(expected)) or getattr(expected, "can_be_none", False)


def _coerce_union(value: Any, expected: Any, current: Any, path: str) -> Any:
    for option in get_args(expected):
        try:
            return coerce(value, option, current, path)
        except TypeError:
            continue
    raise _mismatch(value, expected, path)


def _coerce_literal(value: Any, expected: Any, path: str) -> Any:
    names = get_args(expected)
    if value in names and type(value) in (type(name) for name in names):
        return value
    hint = f" {did_you_mean(value, map(str, names))}" if isinstance(value, str) else ""
    raise TypeError(f"{_mismatch(value, expected, path)}{hint}")


def _named_config(value: str, kind: Any, path: str) -> Any:
    try:
        return kind.from_name(value)
    except ValueError as error:
        raise ValueError(f"'{path}': {error}") from error


def _coerce_callable(value: Any, expected: Any, path: str) -> Any:
    if not isinstance(value, str):
        return _check(callable(value), value, value, expected, path)
    try:
        return resolve_callable(value)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _coerce_enum(value: str, kind: type[enum.Enum], path: str) -> enum.Enum:
    if value not in kind.__members__:
        raise ValueError(f"{path}: {kind.__name__} has no member '{value}'. {did_you_mean(value, kind.__members__)}")
    return kind[value]


def _coerce_sequence(value: Any, expected: Any, kind: type, current: Any, path: str) -> Any:
    _check(isinstance(value, (list, tuple)), value, value, expected, path)
    options = get_args(expected)
    if kind is tuple and options and options[-1] is not Ellipsis:
        _check(len(value) == len(options), value, value, expected, path)
        element_types: Any = options
    else:
        element_types = [options[0] if options else Any] * len(value)
    samples = (
        list(current) if isinstance(current, (list, tuple)) and len(current) == len(value) else [None] * len(value)
    )
    items = zip(value, element_types, samples, strict=True)
    return kind(coerce(item, element, sample, f"{path}.{i}") for i, (item, element, sample) in enumerate(items))


def _coerce_mapping(value: Any, expected: Any, current: Any, path: str) -> dict[Any, Any]:
    _check(isinstance(value, dict), value, value, expected, path)
    element = (get_args(expected) or (Any, Any))[1]
    known = current if isinstance(current, dict) else {}
    return {name: coerce(item, element, known.get(name), f"{path}.{name}") for name, item in value.items()}


def _build_config(value: dict[str, Any], kind: type, current: Any, path: str) -> Any:
    new = copy.deepcopy(current) if isinstance(current, kind) else kind()
    from_dict(new, value, path)
    return new


def _coerce_scalar(value: Any, kind: type, expected: Any, path: str) -> Any:
    if isinstance(value, bool) and kind in (int, float):
        raise _mismatch(value, expected, path)
    if kind is float and isinstance(value, int):
        return float(value)
    if isinstance(value, str) and issubclass(kind, Path):
        return kind(value)
    if isinstance(value, str) and kind is slice and (match := _SLICE.fullmatch(value)):
        return slice(*(None if part == "None" else int(part) for part in match.groups()))
    is_letters = isinstance(value, str) and kind is not str  # a string is a Sequence too, but never meant as one
    return _check(isinstance(value, kind) and not is_letters, value, value, expected, path)


def _check(fits: bool, result: Any, value: Any, expected: Any, path: str) -> Any:
    if not fits:
        raise _mismatch(value, expected, path)
    return result


def _mismatch(value: Any, expected: Any, path: str) -> TypeError:
    name = expected.__name__ if isinstance(expected, type) and not get_args(expected) else str(expected)
    return TypeError(f"'{path}' expects {name.replace('typing.', '')}, got {type(value).__name__} {value!r}.")
