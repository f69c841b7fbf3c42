# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configurations of a run on disk: read back as the base of playing and resuming."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from arcgym.utils.coerce import from_dict, to_plain
from arcgym.utils.errors import UsageError
from arcgym.utils.string import resolve_callable

Plain = dict[str, Any]
"""Nested dicts, lists, texts and numbers."""

NOT_RESTORED = {
    "env": ("log_dir", "recorders", "seed", "sim.device"),
    "agent": ("experiment_name", "run_name", "resume", "load_run", "load_checkpoint"),
}
"""Fields that belong to one start of a program and not to the task or the agent."""

TRUSTED = ("arcgym", "arcgym_tasks", "rsl_rl")
"""Packages whose functions a parameter file may name; those that the task's own configurations name come on top."""

NO_CODE = ("usd_path",)
"""Fields whose values are no code, though a part of a population looks like it: ``population:train``."""

_CALLABLE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*")
_DOTTED = re.compile(r"[A-Za-z_]\w*(\.\w+)+")


BEGUN_FROM = ("init_policy", "teacher_checkpoint")
"""Fields of an agent that name a checkpoint from which it learns."""


@dataclass(frozen=True)
class RunParams:
    """What ``params/`` of a run holds."""

    folder: Path
    """Folder of the files."""

    task: str
    """Task that the run was started with."""

    agent_key: str | None
    """Registry key of its agent; None where the run does not say."""

    env: Plain
    """Configuration of the environment."""

    agent: Plain
    """Configuration of the agent."""

    command: tuple[str, ...] = ()
    """Words of the command that started it, as far as the run says so."""

    resumed_from: Path | None = None
    """Checkpoint that the run went on from; None for a run from the beginning."""


def read_params(run: Path) -> RunParams | None:
    """Return the parameters of a run, or None where its folder has none.

    Raises:
        UsageError: A file is damaged.
    """
    folder = run / "params"
    contents = {}
    for name in ("run", "env", "agent"):
        path = folder / f"{name}.yaml"
        if not path.is_file():
            return None
        try:
            contents[name] = yaml.safe_load(path.read_text())
        except (yaml.YAMLError, UnicodeDecodeError) as error:
            raise UsageError(f"{path} is no YAML of plain values: {error}") from error
        if not isinstance(contents[name], dict):
            raise UsageError(f"{path} holds {type(contents[name]).__name__}, expected names with values.")
    about = contents["run"]
    command = about.get("command")
    words = tuple(map(str, command)) if isinstance(command, list) else ()
    before = about.get("resumed_from")
    return RunParams(
        folder,
        str(about.get("task", "")),
        about.get("agent"),
        contents["env"],
        contents["agent"],
        words,
        Path(str(before)) if before else None,
    )


def restore(cfg: Any, saved: Plain, kind: str, keep: Sequence[str] = (), recorded: bool = False) -> None:
    """Write the values of a run into a configuration, in place.

    Args:
        cfg: Configuration as the task is registered.
        saved: Values of the run.
        kind: ``env`` or ``agent``.
        keep: Paths whose values in ``cfg`` stay, such as those that the ``-Play`` variant changes.
        recorded: Whether the values come from a recording, for the message.

    Raises:
        UsageError: A value does not fit this version, or names code of a package that the task does not use.
    """
    wanted = without(saved, [*NOT_RESTORED[kind], *keep])
    _refuse_foreign_code(wanted, to_plain(cfg), kind)
    try:
        from_dict(cfg, wanted)
    except (TypeError, ValueError) as error:
        if recorded:
            raise UsageError(f"The recording's settings do not fit this version: {error}") from error
        raise UsageError(
            f"params/{kind}.yaml of the run does not fit this version: {error} Use --no_params to run the registered "
            "configuration."
        ) from error


def differences(old: Any, new: Any, path: str = "") -> dict[str, tuple[Any, Any]]:
    """Return old and new value by dotted path, where two nested dicts differ."""
    if not (isinstance(old, dict) and isinstance(new, dict)):
        return {} if old == new else {path: (old, new)}
    found: dict[str, tuple[Any, Any]] = {}
    for name in [*old, *(name for name in new if name not in old)]:
        found |= differences(old.get(name), new.get(name), f"{path}.{name}" if path else str(name))
    return found


def without(values: Plain, paths: list[str]) -> Plain:
    """Return nested dicts without the entries at some dotted paths."""
    heads = {path.partition(".")[0]: [] for path in paths if "." in path}  # type: dict[str, list[str]]
    for path in paths:
        if "." in path:
            heads[path.partition(".")[0]].append(path.partition(".")[2])
    whole = {path for path in paths if "." not in path}
    kept = {name: value for name, value in values.items() if name not in whole}
    return {
        name: without(value, heads[name]) if name in heads and isinstance(value, dict) else value
        for name, value in kept.items()
    }


def _refuse_foreign_code(saved: Plain, own: Plain, kind: str) -> None:
    """Raise if a value names a function of a package that neither ARCGym nor the task's configuration uses."""
    trusted = {*TRUSTED, *(text.partition(":")[0].partition(".")[0] for _, text in _code(own))}
    for path, text in _code(saved):
        root = re.split("[:.]", text)[0]
        if root in trusted and ":" in text:
            root = str(getattr(resolve_callable(text), "__module__", root)).partition(".")[0]
        if root not in trusted:
            raise UsageError(
                f"params/{kind}.yaml of the run names the code '{text}' at '{path}', which is of none of the packages "
                f"{', '.join(sorted(trusted))}. Use --no_params, and name it as an override if you trust it."
            )


def _code(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Yield path and text of every value that names a function or a class."""
    if isinstance(value, dict):
        for name, child in value.items():
            if name not in NO_CODE:
                yield from _code(child, f"{path}.{name}" if path else str(name))
    elif isinstance(value, list):
        for index, child in enumerate(value):
            yield from _code(child, f"{path}.{index}")
    elif isinstance(value, str):
        is_class_name = path.rpartition(".")[2] in ("class_name", "class_type", "func")
        if _CALLABLE.fullmatch(value) or (is_class_name and _DOTTED.fullmatch(value)):
            yield path, value
