# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The pages of configurations: every class with its fields, and every path that the command line can set."""

from __future__ import annotations

import dataclasses
import importlib
import pkgutil
from collections.abc import Iterator

from markdown import code, plain, table

from arcgym.utils.config_reference import fields_of, leaves_of
from arcgym.utils.registry import load_cfg_from_registry

ROBOTS = ("Capsule", "Magnetic", "Proximal")


def config_classes() -> list[type]:
    """Return every configuration class of both packages, by module and name."""
    found = {
        f"{value.__module__}.{value.__qualname__}": value
        for module in _modules()
        for value in vars(module).values()
        if isinstance(value, type) and value.__module__ == module.__name__ and _is_config(value)
    }
    return [found[name] for name in sorted(found)]


def classes_page() -> str:
    """Return the page of classes."""
    parts = [
        "# Configuration classes\n",
        "Made from the code: every field with type, default and when to change it. The search box finds fields; a "
        "field's path on the command line stands in [Paths](paths.md).\n",
    ]
    room = ""
    for config in config_classes():
        here = ".".join(config.__module__.split(".")[:2])
        parts += [f"## Classes of {code(here)}\n"] * (here != room)
        parts.append(_section(config))
        room = here
    return "\n".join(parts)


def paths_page() -> str:
    """Return the page of paths, of the tasks in the sigmoid colon."""
    parts = [
        "# Paths\n",
        "Made from the code: what `arcgym train --task ARC-Sigmoid-Proximal PATH=VALUE` can set, and its default. "
        "Other segments differ in `env.segment` alone; other robots as shown below. `arcgym train` refuses a path "
        "that does not exist and names the nearest.\n",
        "## Environment\n",
        _paths(_env_leaves("Proximal")),
        "## Agent\n",
        _paths(list(leaves_of(load_cfg_from_registry("ARC-Sigmoid-Proximal", "rsl_rl_cfg_entry_point"), "agent"))),
    ]
    common = {(path, value) for path, value, _ in _env_leaves("Proximal")}
    for robot in ROBOTS[:2]:
        parts.append(f"## Where the {robot.lower()} differs\n")
        parts.append(_paths([leaf for leaf in _env_leaves(robot) if leaf[:2] not in common]))
    return "\n".join(parts)


def _is_config(value: type) -> bool:
    """Return whether a class was made by ``configclass``, and is no plain dataclass."""
    return dataclasses.is_dataclass(value) and hasattr(value, "validate") and hasattr(value, "replace")


def _env_leaves(robot: str) -> list[tuple[str, str, str]]:
    return list(leaves_of(load_cfg_from_registry(f"ARC-Sigmoid-{robot}", "env_cfg_entry_point"), "env"))


def _paths(leaves: list[tuple[str, str, str]]) -> str:
    rows = ((code(path), code(value), plain(text)) for path, value, text in leaves)
    return table(("Path", "Default", "Description"), rows)


def _section(config: type) -> str:
    rows = [(code(f.name), code(f.type), code(f.default), plain(f.description)) for f in fields_of(config)]
    fields = table(("Field", "Type", "Default", "Description"), rows) if rows else "No fields.\n"
    return f"### {config.__qualname__}\n\n{code(config.__module__)}. {plain(_summary(config))}\n\n{fields}"


def _summary(config: type) -> str:
    return " ".join((config.__dict__.get("__doc__") or "").split("\n\n")[0].split())


def _modules() -> Iterator[object]:
    for package in ("arcgym", "arcgym_tasks"):
        root = importlib.import_module(package)
        for info in pkgutil.walk_packages(root.__path__, f"{package}."):
            if not info.name.endswith("__main__"):
                yield importlib.import_module(info.name)
