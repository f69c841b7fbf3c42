# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""From a study's configuration to its cells, in Hydra's grammar."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from arcgym.studies.cell import Cell
from arcgym.studies.study_cfg import AXES, ROBOTS, StudyCfg

NAMED = ("algorithm", "task", "robot", "seed")
"""Axes that every cell's name has; others are appended."""

_PLAIN = re.compile(r"[A-Za-z_][\w./+-]*|-?\d+(\.\d+)?(e-?\d+)?")


def sweep_overrides(cfg: StudyCfg) -> list[str]:
    """Return the grid as overrides that Hydra's sweeper multiplies out, such as ``seed=1,2,3``."""
    return [f"{_key(name)}={','.join(hydra_value(value) for value in values)}" for name, values in cfg.grid.items()]


def hydra_value(value: Any) -> str:
    """Return a value as Hydra's grammar writes it."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, tuple)):
        return f"[{','.join(hydra_value(item) for item in value)}]"
    if isinstance(value, Mapping):
        return "{" + ",".join(f"{key}:{hydra_value(item)}" for key, item in value.items()) + "}"
    text = str(value)
    return text if _PLAIN.fullmatch(text) else "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def is_left_out(values: Mapping[str, Any]) -> bool:
    """Return whether one of ``skip`` leaves out the cell of these values, which are those of :func:`make_cell`."""
    return any(
        all(_value(values, name) in (given if isinstance(given, list) else [given]) for name, given in names.items())
        for names in values.get("skip", ())
    )


def make_cell(values: Mapping[str, Any], study: Path) -> Cell:
    """Return a cell from a study's configuration in which each name of the grid has one value.

    Settings of the task come on top of the study's, those of the algorithm on top of both, then those that the
    algorithm has for the robot, and the grid's last.

    Args:
        values: Fields of :class:`StudyCfg` as plain values, ``axes``, the names that the grid varies, and
            ``fixed``, budgets that the command line gives as one value.
        study: Folder of the study.
    """
    task = _full_name(str(values["task"]), values["robot"]) if values.get("robot") else values["task"]
    own = values["algorithms"].get(values["algorithm"], {})
    groups = [values["tasks"].get(task, {}), own, own.get(ROBOTS, {}).get(task.rpartition("-")[2], {})]
    merged = {name: values[name] for name in ("num_envs", "minutes", "max_iterations", "suites")}
    overrides: dict[str, Any] = {}
    whole: list[str] = []
    for group in ({"env": values["env"], "agent": values["agent"]}, *groups):
        merged |= {name: value for name, value in group.items() if name not in ("env", "agent", "overrides", ROBOTS)}
        whole += group.get("overrides", ())
        for kind in ("env", "agent"):
            overrides |= dict(_leaves(group.get(kind, {}), kind))
    merged |= {name: values[name] for name in values.get("fixed", ())}
    axes = {}
    for name in values["axes"]:
        if name not in NAMED:
            axes[name] = _value(values, name)
            (merged if name in AXES else overrides)[name] = axes[name]
    merged["suites"] = tuple(merged["suites"])
    texts = (*(f"{path}={hydra_value(value)}" for path, value in overrides.items()), *whole)
    return Cell(
        study, task, values["algorithm"], values["seed"], axes, evaluate=values["evaluate"], overrides=texts, **merged
    )


def _full_name(segment: str, robot: str) -> str:
    """Return the registered name of a task: ``rectum`` and ``LeftColon`` stand for ARC-Rectum-… and ARC-LeftColon-…"""
    return f"ARC-{segment[:1].upper()}{segment[1:]}-{robot}"


def _value(values: Mapping[str, Any], name: str) -> Any:
    """Return the value of a name that the grid may vary."""
    return values[name] if name in AXES else _at(values, name)


def _key(name: str) -> str:
    """Return the key of an override; paths need not exist in the study's configuration."""
    return f"++{name}" if name.startswith(("env.", "agent.")) else name


def _leaves(values: Mapping[str, Any], path: str) -> Iterator[tuple[str, Any]]:
    for name, value in values.items():
        if isinstance(value, Mapping) and value:
            yield from _leaves(value, f"{path}.{name}")
        else:
            yield f"{path}.{name}", value


def _at(values: Mapping[str, Any], path: str) -> Any:
    for part in path.split("."):
        values = values[part]
    return values
