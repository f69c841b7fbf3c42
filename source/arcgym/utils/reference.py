# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Terms as data, read from their signatures and docstrings, for reference tables."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any

KINDS = {
    "observations": ("observation",),
    "rewards": ("reward", "metrics"),
    "costs": ("cost", "metrics"),
    "terminations": ("termination",),
    "events": ("event",),
    "curriculums": ("curriculum",),
    "metrics": ("metrics",),
    "load_metrics": ("metrics",),
}
"""Managers that the terms of a module serve, by the module's name. Terms of other modules serve all that take their
shape and type: see :func:`kinds_of`."""

LEADING = ("self", "env", "env_ids")
"""Arguments that managers give."""

_RETURNS = ("torch.Tensor", "float", "None")


@dataclass(frozen=True)
class ParamReference:
    """A parameter of a term."""

    name: str
    """Name, as in the term's ``params``."""

    default: str
    """Default as it is written, or ``required``."""

    description: str
    """Meaning and unit, from the docstring's ``Args``."""

    expected: str
    """Bounds or names that validation asks for; empty where any value passes."""


@dataclass(frozen=True)
class TermReference:
    """A term of a manager."""

    name: str
    """Name inside its package, such as ``load_above``."""

    module: str
    """Module that defines it."""

    kinds: tuple[str, ...]
    """Managers that it serves."""

    summary: str
    """First paragraph of its docstring, with unit and shape."""

    params: tuple[ParamReference, ...]
    """Parameters in order."""


def terms_of(package: ModuleType) -> list[TermReference]:
    """Return the terms among the public names of a package, in the order of their modules and names.

    A term is a function ``(env, ...)`` or ``(env, env_ids, ...)``, or a class whose instances are called so.

    Args:
        package: Package of terms, such as :mod:`arcgym.envs.mdp`.
    """
    found = [describe(value) for value in vars(package).values() if _is_term(value, package.__name__)]
    return sorted(found, key=lambda term: (term.module, term.name))


def describe(term: Any) -> TermReference:
    """Return a term's reference.

    Args:
        term: Function or class.
    """
    call = term.__call__ if isinstance(term, type) else term
    descriptions = arguments_of(inspect.getdoc(call) or "")
    expected = getattr(term, "expected_params", {})
    params = tuple(
        ParamReference(name, _default(parameter), descriptions.get(name, ""), _bounds(expected.get(name)))
        for name, parameter in inspect.signature(call).parameters.items()
        if name not in LEADING
    )
    summary = " ".join((inspect.getdoc(term) or "").split("\n\n")[0].split())
    return TermReference(term.__name__, term.__module__, kinds_of(term, summary), summary, params)


def kinds_of(term: Any, summary: str) -> tuple[str, ...]:
    """Return the managers that a term serves: its module's, or those that take the shape that its summary states."""
    module = term.__module__.rpartition(".")[2]
    if module in KINDS:
        return KINDS[module]
    if "shape (N,)" not in summary:
        return ("observation",)
    return ("reward", "cost", "metrics") + (("termination",) if "bool" in summary else ())


def arguments_of(docstring: str) -> dict[str, str]:
    """Return the descriptions below ``Args:`` of a Google-style docstring by the arguments' names."""
    block = re.search(r"^Args:\n(.*?)(?:\n\S|\Z)", docstring, flags=re.DOTALL | re.MULTILINE)
    if block is None:
        return {}
    entries = re.findall(r"^    (\w+): (.*?)(?=^    \w+: |\Z)", block[1] + "\n", flags=re.DOTALL | re.MULTILINE)
    return {name: " ".join(text.split()) for name, text in entries}


def _is_term(value: Any, package: str) -> bool:
    if not getattr(value, "__module__", "").startswith(f"{package}."):
        return False
    if isinstance(value, type):
        return "__call__" in vars(value) and _takes_env(value.__call__)
    return inspect.isfunction(value) and _takes_env(value) and _stands_in_a_term_module(value)


def _takes_env(call: Any) -> bool:
    names = [name for name in inspect.signature(call).parameters if name != "self"]
    return names[:1] == ["env"] and inspect.signature(call).return_annotation in _RETURNS


def _stands_in_a_term_module(value: Any) -> bool:
    """Return whether a function is a term rather than a helper: helpers of shared modules return no tensor."""
    module = value.__module__.rpartition(".")[2]
    return module in KINDS or inspect.signature(value).return_annotation == "torch.Tensor"


def _default(parameter: inspect.Parameter) -> str:
    if parameter.default is parameter.empty:
        return "required"
    entity = getattr(parameter.default, "name", None)
    return f"SceneEntityCfg({entity!r})" if entity is not None else repr(parameter.default)


def _bounds(expected: Any) -> str:
    if expected is None:
        return ""
    return ", ".join(_names(expected)) if hasattr(expected, "__iter__") else str(expected)


def _names(expected: Any) -> Iterator[str]:
    return (f"``{name}``" for name in expected)
