# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Arguments that subcommands share, as typed dataclasses. Importing this loads neither torch nor Newton."""

from __future__ import annotations

import argparse
import dataclasses
import typing
from dataclasses import dataclass
from typing import Any, TypeVar

T = TypeVar("T")


def argument(help: str, default: Any = dataclasses.MISSING, **options: Any) -> Any:  # noqa: A002 - as in argparse
    """Return a dataclass field that is an argument of the command line.

    Args:
        help: Text of ``--help``.
        default: Value where the argument is not given; without one the argument must be given.
        options: Further options of ``add_argument``, and ``group``, the heading in ``--help``.
    """
    return dataclasses.field(default=default, metadata={"help": help, **options})


def add_fields(parser: argparse.ArgumentParser, cls: type) -> None:
    """Declare an argument for each field of a dataclass that was made by :func:`argument`."""
    types = typing.get_type_hints(cls)
    groups: dict[str, Any] = {}
    for field in dataclasses.fields(cls):
        if not field.metadata:
            continue
        options = dict(field.metadata)
        title = options.pop("group", None)
        target: Any = groups.setdefault(title, parser.add_argument_group(title)) if title else parser
        if types[field.name] is bool:
            target.add_argument(f"--{field.name}", action="store_true", **options)
        elif field.default is dataclasses.MISSING:
            target.add_argument(f"--{field.name}", required=True, **options)
        else:
            target.add_argument(f"--{field.name}", default=field.default, **options)


def read_fields(cls: type[T], args: argparse.Namespace) -> T:
    """Return the dataclass that :func:`add_fields` declared, filled with parsed arguments."""
    return cls(**{field.name: getattr(args, field.name) for field in dataclasses.fields(cls)})  # type: ignore[arg-type]


def whole(least: int) -> typing.Callable[[str], int]:
    """Return the reader of a whole number that is not below ``least``."""

    def read(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"'{text}' is no whole number, expected {least} or more") from None
        if number < least:
            raise argparse.ArgumentTypeError(f"{number} is too small, expected {least} or more")
        return number

    return read


positive = whole(1)
"""Reader of a whole number of at least 1."""


def counts(text: str) -> list[int]:
    """Read numbers of at least 1 that commas separate."""
    return [positive(part) for part in text.split(",")]


DEFAULT_AGENT = "rsl_rl_cfg_entry_point"
"""Registry key of a task's first agent."""


@dataclass(frozen=True, kw_only=True)
class TaskArguments:
    """Arguments of every subcommand that runs a task."""

    task: str = argument("task name; 'arcgym list' names them")
    num_envs: int | None = argument("number of worlds (default: the task's)", None, type=positive)
    seed: int | None = argument("seed of environment and networks (default: the agent's)", None, type=int)
    device: str | None = argument("cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)", None)
    agent: str = argument("agent: ppo (default), sac, a2c, ... or a registry key", DEFAULT_AGENT)
    headless: bool = argument("accepted for Isaac Lab's sake: there is no window", False)
    overrides: list[str] = dataclasses.field(default_factory=list)
    """Texts ``env.path=value`` and ``agent.path=value``."""


@dataclass(frozen=True, kw_only=True)
class RunArguments(TaskArguments):
    """Arguments that choose a training run and its checkpoint."""

    experiment_name: str | None = argument("folder below logs/rsl_rl (default: the agent's)", None, group="run")
    load_run: str | None = argument(
        "run folder, or a regular expression for it (default: the newest)", None, group="run"
    )
    checkpoint: str | None = argument("path, file name, 'latest' or 'best' (default: latest)", None, group="run")
    no_params: bool = argument("use the registered configurations, not those of the run", False, group="run")


@dataclass(frozen=True, kw_only=True)
class FilmedRunArguments(RunArguments):
    """The same for subcommands that film what they run."""

    video: bool = argument("record MP4 videos", False, group="video")
    video_length: int = argument("control steps of a video (default: 200)", 200, type=positive, group="video")
