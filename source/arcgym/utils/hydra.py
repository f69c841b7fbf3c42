# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Command-line overrides in Hydra's grammar: ``env.scene.num_envs=4 agent.algorithm.learning_rate=1e-4``.

Overrides are written into finished configurations, after every ``__post_init__``, so that what the user typed stands.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from arcgym.utils.coerce import coerce, field_types, is_config, is_missing
from arcgym.utils.string import did_you_mean

if TYPE_CHECKING:
    from hydra.core.override_parser.types import Override


def apply_overrides(cfgs: dict[str, Any], overrides: Sequence[str]) -> None:
    """Write overrides into configurations, in place.

    Args:
        cfgs: Configurations by the first word of the path, e.g. ``{"env": env_cfg, "agent": agent_cfg}``.
        overrides: Texts ``path=value``. ``path`` goes through fields, dict keys and list positions; ``+path=value``
            adds a dict key that is not there yet; ``null`` switches a term off.

    Raises:
        ValueError: If a text cannot be parsed or a path does not exist, with the names that exist at that level.
        TypeError: If a value does not fit its field, with the expected type.
    """
    for text in overrides:
        _apply(cfgs, _parse(text), text)


def _parse(text: str) -> Override:
    # Imported here: a command without overrides starts half a second earlier.
    from hydra.core.override_parser.overrides_parser import OverridesParser
    from hydra.errors import HydraException

    try:
        return OverridesParser.create().parse_override(text)
    except HydraException as error:
        raise ValueError(f"Cannot read the override '{text}': expected path=value. {error}") from error


def _apply(cfgs: dict[str, Any], override: Override, text: str) -> None:
    from hydra.core.override_parser.types import OverrideType

    if override.type not in (OverrideType.CHANGE, OverrideType.ADD) or override.is_sweep_override():
        raise ValueError(f"The override '{text}' deletes or sweeps: expected path=value; use path=null to switch off.")
    path = override.key_or_group
    *parents, name = path.split(".")
    node: Any = cfgs
    for depth, part in enumerate(parents):
        node = _child(node, part, ".".join(parents[:depth]))
    _assign(node, name, override.value(), path, override.type is OverrideType.ADD)


def _child(node: Any, name: str, path: str) -> Any:
    """Return what ``name`` holds inside ``node``, which sits at ``path``."""
    names = _names(node, path)
    if name not in names:
        owner = f"'{path}'" if path else "The command"
        raise ValueError(f"{owner} has no field '{name}'. {did_you_mean(name, names)}")
    if isinstance(node, dict):
        return node[name]
    return node[int(name)] if isinstance(node, (list, tuple)) else getattr(node, name)


def _assign(node: Any, name: str, value: Any, path: str, adds: bool) -> None:
    parent = path.rpartition(".")[0]
    if not parent:
        raise ValueError(_without_parent(node, name))
    if adds and isinstance(node, dict) and name not in node:
        node[name] = value
        return
    current = _child(node, name, parent)
    if isinstance(node, dict):
        node[name] = coerce(value, Any, current, path)
    elif isinstance(node, list):
        node[int(name)] = coerce(value, Any, current, path)
    elif isinstance(node, tuple):
        raise TypeError(f"'{parent}' is a tuple: give all its values, {parent}={list(node)}.")
    else:
        setattr(node, name, coerce(value, field_types(type(node)).get(name, Any), current, path))


def _names(node: Any, path: str) -> list[str]:
    if is_config(node):
        return list(vars(node))
    if isinstance(node, dict):
        return [str(key) for key in node]
    if isinstance(node, (list, tuple)):
        return [str(index) for index in range(len(node))]
    if node is None or is_missing(node):
        raise ValueError(f"'{path}' is {'not set' if node else 'switched off (None)'}: it has no fields to override.")
    raise ValueError(f"'{path}' is the value {node!r}: it has no fields to override.")


def _without_parent(cfgs: dict[str, Any], name: str) -> str:
    """Return the message for an override of one word, which names a whole configuration or none."""
    if name in cfgs:
        fields = ", ".join(sorted(_names(cfgs[name], name)))
        return f"'{name}' is a whole configuration: name a field inside it. Available: {fields}."
    paths = [f"{owner}.{name}" for owner, cfg in cfgs.items() if name in _names(cfg, owner)]
    if paths:
        return f"The command has no field '{name}'. Did you mean {' or '.join(repr(path) for path in paths)}?"
    return f"The command has no field '{name}': begin with {' or '.join(repr(f'{owner}.') for owner in cfgs)}."
