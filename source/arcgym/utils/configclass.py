# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration classes: dataclasses that nest, subclass and copy the way Isaac Lab users expect.

A class under :func:`configclass` is a plain dataclass with these conveniences:

* A member needs no annotation: ``joint_pos = ObsTerm(func=mdp.joint_pos)`` is a field. Those with one come first, in
  their order, and then the others in theirs, which is the order of a manager's terms.
* Defaults may be mutable; every instance gets its own deep copy.
* A field without default, or with :data:`MISSING`, must be set before :func:`validate` is called.
* A subclass overrides a field by assigning it again; ``= None`` switches a term off.
* A subclass may call ``super().__post_init__()`` whether or not its base class defines one.
* Instances have ``copy()``, ``replace()``, ``to_dict()``, ``from_dict()`` and ``validate()``.
"""

from __future__ import annotations

import copy as copy_module
import dataclasses
import functools
import math
import reprlib
import textwrap
import types
from collections.abc import Callable, Iterator
from typing import Any, TypeVar, dataclass_transform

from arcgym.utils.coerce import check_declared, field_types, from_dict, is_config, is_missing, to_plain
from arcgym.utils.string import did_you_mean, nearest
from arcgym.utils.validation import FieldError

__all__ = ["MISSING", "configclass", "copy", "from_dict", "is_config", "replace", "to_dict", "validate"]

T = TypeVar("T")

MISSING: Any = dataclasses.MISSING
"""Value of a field that must be set, the same object as ``dataclasses.MISSING``."""

_REPR_WIDTH = 120
"""Longest list of fields in a configuration's ``repr``."""

_NEVER_FIELDS = (types.FunctionType, classmethod, staticmethod, property, functools.cached_property, type)
_ATOMIC = (type(None), bool, int, float, complex, str, bytes, type, types.FunctionType, types.BuiltinFunctionType)


@dataclass_transform(field_specifiers=(dataclasses.field,))
def configclass(cls: type[T]) -> type[T]:
    """Turn a class into a configuration class; see the module's docstring."""
    cls.__annotations__ = _complete_annotations(cls)
    for name, annotation in cls.__annotations__.items():
        if not _is_class_variable(annotation):
            setattr(cls, name, _as_field(cls.__dict__.get(name, MISSING)))
    methods = {
        "copy": copy,
        "replace": replace,
        "to_dict": to_dict,
        "from_dict": from_dict,
        "validate": validate,
        "__deepcopy__": _deepcopy,
    }
    if "__repr__" not in cls.__dict__:
        cls.__repr__ = _short_repr  # type: ignore[method-assign, assignment]
    for name, method in methods.items():
        if not hasattr(cls, name):
            setattr(cls, name, method)
    if not hasattr(cls, "__post_init__"):
        setattr(cls, "__post_init__", _no_post_init)  # noqa: B010 - unknown to type checkers
    return dataclasses.dataclass(cls, repr=False)


def copy(cfg: T) -> T:
    """Return a deep copy; ``__post_init__`` does not run again."""
    return copy_module.deepcopy(cfg)


def replace(cfg: T, **changes: Any) -> T:
    """Return a copy with some fields changed; ``__post_init__`` does not run again, so the changes stand.

    Raises:
        ValueError: If a name is not a field.
    """
    new = copy(cfg)
    for name, value in changes.items():
        if name not in vars(new):
            raise ValueError(f"{type(cfg).__name__} has no field '{name}'. {did_you_mean(name, vars(new))}")
        setattr(new, name, value)
    return new


def to_dict(cfg: Any) -> dict[str, Any]:
    """Return nested dicts of plain values, fit for YAML: callables become ``"module:name"``, tuples lists."""
    return to_plain(cfg)


def validate(cfg: Any, name: str = "") -> None:
    """Check a configuration and everything inside it, before anything is built from it.

    Nothing may be missing, numbers must not be NaN and must have the type of their field, texts of ``Literal`` fields
    be among its names, and no attribute may be set that is no field. Then the ``validate_config(self)`` of every nested
    configuration that has one runs; see :mod:`arcgym.utils.validation` for bounds. ``__post_init__`` checks nothing:
    overrides are written after it.

    Args:
        cfg: Configuration.
        name: Where it sits, as on the command line, such as ``env``; the first word of every path in messages.

    Raises:
        ValueError: The first value that cannot be used, with its path, or all missing paths.
        TypeError: If a number or name has another type than its field.
    """
    entries = list(_walk(cfg, name))
    missing = [path for path, value in entries if is_missing(value)]
    if missing:
        raise ValueError(f"{type(cfg).__name__} has fields without a value: {', '.join(missing)}. Set each.")
    for path, value in entries:
        if isinstance(value, float) and math.isnan(value):
            raise ValueError(f"{path} is nan, expected a number.")
    nested = [(path, value) for path, value in entries if is_config(value)]
    for path, value in nested:
        _refuse_unknown_names(value, path)
        check_declared(value, path)
    for path, value in reversed(nested):  # the inner ones first: cross-checks may rely on them
        check = getattr(value, "validate_config", None)
        if check is not None:
            _run_check(check, path, is_root=path == name)


def _refuse_unknown_names(cfg: Any, path: str) -> None:
    """Check that nobody has set an attribute that is no field, as ``cfg.widht = 20`` does.

    A configuration may be given further members, such as a term or a sensor; ``None`` takes one of these away, and is
    refused where a field has nearly that name.

    Raises:
        ValueError: With the nearest field.
    """
    names = [field.name for field in dataclasses.fields(cfg)]
    for name, value in vars(cfg).items():
        if name in names or name.startswith("_") or is_config(value):
            continue
        if value is None and not nearest(name, names):
            continue
        raise ValueError(f"{path or type(cfg).__name__} has no field '{name}'. {did_you_mean(name, names)}")


def _run_check(check: Callable[[], None], path: str, is_root: bool) -> None:
    """Call a configuration's own check and put its path before what it raises."""
    try:
        check()
    except FieldError as error:
        raise ValueError(f"{_joined(path, error.field)} {error.text}") from error
    except ValueError as error:
        raise ValueError(str(error) if is_root else f"{path}: {error}") from error


def _joined(path: str, name: object) -> str:
    return f"{path}.{name}" if path else str(name)


def _complete_annotations(cls: type) -> dict[str, Any]:
    """Return annotations of the class's own members: the written ones, then those of the others, in order."""
    written = dict(cls.__dict__.get("__annotations__", {}))
    inherited = _inherited_annotations(cls)
    for name, value in cls.__dict__.items():
        if name in written or name.startswith("_"):
            continue
        if name in inherited:
            written[name] = inherited[name]
        elif not isinstance(value, _NEVER_FIELDS):
            written[name] = Any if isinstance(value, dataclasses.Field) or value is None else type(value)
    return written


def _inherited_annotations(cls: type) -> dict[str, Any]:
    """Return field name to type over all bases, resolved where each was written."""
    found: dict[str, Any] = {}
    for base in reversed(cls.__mro__[1:]):
        if dataclasses.is_dataclass(base):
            hints = field_types(base)
            found.update({field.name: hints[field.name] for field in dataclasses.fields(base)})
    return found


def _is_class_variable(annotation: Any) -> bool:
    return "ClassVar" in (annotation if isinstance(annotation, str) else str(annotation))


def _as_field(value: Any) -> Any:
    """Return the default of a dataclass field: shared when it cannot change, copied for each instance otherwise."""
    if isinstance(value, dataclasses.Field) or isinstance(value, _ATOMIC):
        return value
    if is_missing(value):
        return dataclasses.field(default_factory=lambda: MISSING)
    return dataclasses.field(default_factory=lambda: copy_module.deepcopy(value))


def _deepcopy(self: Any, memo: dict[int, Any]) -> Any:
    """Copy attribute by attribute and keep :data:`MISSING` the object it is."""
    memo[id(MISSING)] = MISSING
    new = object.__new__(type(self))
    memo[id(self)] = new
    for name, value in vars(self).items():
        object.__setattr__(new, name, copy_module.deepcopy(value, memo))
    return new


def _short_repr(self: Any) -> str:
    """Return name and fields in one short line, nested configurations by their names; ``to_dict`` shows everything."""
    shown = []
    for name, value in vars(self).items():
        shown.append(f"{name}={f'{type(value).__name__}(...)' if is_config(value) else reprlib.repr(value)}")
    return f"{type(self).__name__}({textwrap.shorten(', '.join(shown), _REPR_WIDTH, placeholder=' ...')})"


def _no_post_init(self: Any) -> None:
    """Let subclasses call ``super().__post_init__()``."""


def _walk(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield path and value of ``value`` and of everything nested in configurations, dicts and sequences."""
    yield path, value
    items: Any = ()
    if is_config(value):
        items = vars(value).items()
    elif isinstance(value, dict):
        items = value.items()
    elif isinstance(value, (list, tuple)):
        items = enumerate(value)
    for name, child in items:
        yield from _walk(child, _joined(path, name))
