# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration classes as data, read from their annotations and docstrings, for reference tables."""

from __future__ import annotations

import ast
import dataclasses
import inspect
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from arcgym.utils.coerce import is_config, is_missing


@dataclass(frozen=True)
class FieldReference:
    """A field of a configuration class."""

    name: str
    """Name."""

    type: str
    """Type as it is written."""

    default: str
    """Default as it is written, ``required``, or the class of a nested configuration."""

    description: str
    """The field's docstring, or that of the nearest base class that has one."""


def fields_of(config: type) -> list[FieldReference]:
    """Return the fields of a configuration class in their order, inherited ones first.

    Args:
        config: Class under :func:`arcgym.utils.configclass`.
    """
    descriptions = _descriptions(config)
    return [
        FieldReference(field.name, _type(field), shown(_default(field)), descriptions.get(field.name, ""))
        for field in dataclasses.fields(config)
    ]


def leaves_of(cfg: Any, path: str) -> Iterator[tuple[str, str, str]]:
    """Yield path, value and description of everything that the command line can set in a configuration.

    Args:
        cfg: Instance of a configuration class.
        path: First words of the paths, such as ``env``.
    """
    descriptions = _descriptions(type(cfg))
    for name, value in vars(cfg).items():
        here = f"{path}.{name}"
        if is_config(value):
            yield from leaves_of(value, here)
        elif isinstance(value, dict) and any(is_config(entry) for entry in value.values()):
            for key, entry in value.items():
                yield from leaves_of(entry, f"{here}.{key}")
        else:
            yield here, shown(value), descriptions.get(name, "")


def shown(value: Any) -> str:
    """Return a value as a reference shows it: configurations, functions and classes by their names."""
    if is_missing(value):
        return "required"
    if is_config(value):
        return f"{type(value).__name__}()"
    if inspect.isfunction(value) or isinstance(value, type):
        return value.__name__
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key!r}: {shown(entry)}" for key, entry in value.items()) + "}"
    return repr(value)


def _default(field: dataclasses.Field[Any]) -> Any:
    factory: Any = field.default_factory
    return field.default if is_missing(factory) else factory()


def _type(field: dataclasses.Field[Any]) -> str:
    return field.type if isinstance(field.type, str) else getattr(field.type, "__name__", str(field.type))


def _descriptions(config: type) -> dict[str, str]:
    """Return the docstrings below the fields by name, those of base classes first."""
    found: dict[str, str] = {}
    for base in reversed(config.__mro__):
        if dataclasses.is_dataclass(base):
            found |= dict(_docstrings(base))
    return found


def _docstrings(config: type) -> Iterator[tuple[str, str]]:
    """Yield name and docstring of the members that a class itself documents."""
    try:
        body = ast.parse(textwrap.dedent(inspect.getsource(config))).body[0].body  # type: ignore[attr-defined]
    except (OSError, TypeError):
        return
    for member, text in zip(body, body[1:], strict=False):
        target = getattr(member, "target", None) or next(iter(getattr(member, "targets", [])), None)
        is_text = isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant)
        if isinstance(target, ast.Name) and is_text:
            yield target.id, " ".join(str(text.value.value).split())
