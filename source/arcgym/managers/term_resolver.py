# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Turns configured terms into callables and checks that they fit, for every manager alike."""

from __future__ import annotations

import copy
import inspect
from collections.abc import Callable, Collection
from typing import Any

from arcgym.managers.scene_entity_cfg import SceneEntityCfg
from arcgym.managers.term_base import ManagerTermBase
from arcgym.managers.term_cfg import ManagerTermBaseCfg
from arcgym.utils.coerce import from_dict
from arcgym.utils.errors import TermError
from arcgym.utils.string import did_you_mean, resolve_callable


def collect_terms(cfg: Any, kind: type, owner: str, skip: Collection[str] = ()) -> dict[str, Any]:
    """Return the terms of a configuration class or dict by name, leaving out those that are None.

    A term may be a dict of its fields.

    Args:
        cfg: Configuration instance, dict, or None for no terms.
        kind: Class that each term must have.
        owner: Manager that holds them, for messages.
        skip: Members that are not terms.

    Raises:
        TermError: If a member is something else, naming owner, term, what it is and what was expected.
    """
    entries = {} if cfg is None else cfg if isinstance(cfg, dict) else vars(cfg)
    terms = {name: term for name, term in entries.items() if term is not None and name not in skip}
    for name, term in terms.items():
        if isinstance(term, dict) and "func" in term:  # as parameters of a run give a term that the task does not have
            terms[name] = term = kind()
            from_dict(term, dict(entries[name]), name)
        if not isinstance(term, kind):
            given = f"the class {term.__name__}" if isinstance(term, type) else f"of type {type(term).__name__}"
            raise TermError(f"Term '{name}' of {owner} is {given}, expected an instance of {kind.__name__}.")
    return terms


def resolve_term(cfg: ManagerTermBaseCfg, env: Any, name: str, owner: str, leading: tuple[str, ...]) -> None:
    """Make ``cfg.func`` callable, in place: text is imported, scene entities are found, classes are constructed.

    Args:
        cfg: Term to resolve.
        env: Environment it belongs to.
        name: Its name, for messages.
        owner: Manager that holds it, for messages.
        leading: Positional arguments that precede the parameters, e.g. ``("env",)``.

    Raises:
        TermError: If the function is not callable or its signature does not fit the parameters.
        ValueError: If a name does not exist.
    """
    label = f"Term '{name}' of {owner}"
    if isinstance(cfg.func, str):
        cfg.func = _named(cfg.func, label)
    func: Any = cfg.func
    is_class = isinstance(func, type)
    if is_class and not issubclass(func, ManagerTermBase):
        raise TermError(f"{label} is the class {func.__name__}, which does not derive from ManagerTermBase.")
    if not callable(func):
        raise TermError(f"{label} has a func of type {type(func).__name__}, expected a callable.")
    signature = inspect.signature(func.__call__ if is_class else func)
    arguments = (("self",) if is_class else ()) + leading
    _check_signature(signature, arguments, cfg.params, label)
    _resolve_entities(signature, cfg.params, env, label)
    if is_class:
        cfg.func = func(cfg, env)


def _named(text: str, label: str) -> Callable[..., Any]:
    try:
        return resolve_callable(text)
    except ValueError as error:
        raise ValueError(f"{label}: {error}") from error


def _check_signature(signature: inspect.Signature, arguments: tuple[str, ...], params: dict, label: str) -> None:
    """Compare the parameters after the leading arguments with those given."""
    parameters = list(signature.parameters.values())
    kinds = {parameter.kind for parameter in parameters}
    is_open = inspect.Parameter.VAR_POSITIONAL in kinds
    if len(parameters) < len(arguments) and not is_open:
        raise TermError(f"{label} must take ({', '.join(arguments)}, ...), but its signature is {signature}.")
    named = [p for p in parameters[len(arguments) :] if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]
    required = [parameter.name for parameter in named if parameter.default is parameter.empty]
    optional = [parameter.name for parameter in named if parameter.default is not parameter.empty]
    absent = [name for name in required if name not in params]
    unknown = [name for name in params if name not in required + optional]
    if absent or (unknown and inspect.Parameter.VAR_KEYWORD not in kinds):
        asked = f"parameters {required}" + (f" and optionally {optional}" if optional else "")
        hint = f" {did_you_mean(unknown[0], required + optional)}" if unknown and required + optional else ""
        raise TermError(f"{label} expects {asked}, got {list(params)}.{hint}")


def _resolve_entities(signature: inspect.Signature, params: dict[str, Any], env: Any, label: str) -> None:
    """Find the parts of scene entities, those in the function's defaults included."""
    for name, parameter in signature.parameters.items():
        if isinstance(parameter.default, SceneEntityCfg) and name not in params:
            params[name] = copy.deepcopy(parameter.default)
    for name, value in params.items():
        if isinstance(value, SceneEntityCfg):
            try:
                value.resolve(env.scene)
            except ValueError as error:
                raise ValueError(f"{label}, parameter '{name}': {error}") from error
