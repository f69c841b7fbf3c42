# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Make the start states of a task ahead: the scripted expert of its robot drives up its colon.

They go into the cache folder (ARCGYM_CACHE), where the task finds them. What lies there already is left as it is.
"""

from __future__ import annotations

import argparse
import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.cli.arguments import add_fields, argument, read_fields
from arcgym.utils.errors import UsageError

TAKES_OVERRIDES = True


@dataclass(frozen=True, kw_only=True)
class SnapshotArguments:
    """Arguments of ``arcgym snapshots``."""

    task: str = argument("task name; 'arcgym list' names them")
    until: str | None = argument("last segment to enter (default: the task's)", None)
    speed: float = argument("speed of the expert [m/s] (default: 0.04)", 0.04, type=float)
    max_time: float = argument("simulated time after which to give up [s] (default: 240)", 240.0, type=float)
    device: str | None = argument("cpu, cuda or cuda:<n> (default: cuda:0 where there is one, else cpu)", None)
    force: bool = argument("make them anew though they are there", False)
    beside_colon: bool = argument("write them beside the colon's stage instead of into the cache", False)
    overrides: list[str] = dataclasses.field(default_factory=list)
    """Texts ``env.path=value``."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_fields(parser, SnapshotArguments)


def run(namespace: argparse.Namespace) -> None:
    """Make the states.

    Raises:
        UsageError: An argument is wrong, or the expert does not arrive.
    """
    args = read_fields(SnapshotArguments, namespace)
    for name in ("speed", "max_time"):
        if getattr(args, name) <= 0.0:
            raise UsageError(f"--{name} is {getattr(args, name):g}, expected more than 0")
    cfg = _env_cfg(args)

    _make_all(args, cfg, _stages(cfg.scene.colon))


def _stages(colon: Any) -> list[Path]:
    """Return the stages of the patients that a configuration names."""
    from arcgym.assets.patient_files import find_stages

    try:
        return find_stages(colon.usd_path, colon.num_patients)
    except (ValueError, OSError) as error:
        raise UsageError(str(error)) from error


def _make_all(args: SnapshotArguments, cfg: Any, stages: list[Path]) -> None:
    """Make the states of every patient; where the expert does not arrive, the others are made all the same.

    Raises:
        UsageError: If the expert does not arrive in some patients; names them.
    """
    from arcgym.start_states.ahead import make_ahead, make_all_ahead
    from arcgym.start_states.progress import say

    until = args.until or cfg.segment
    if len(stages) > 1 and args.beside_colon:
        raise UsageError(f"--beside_colon writes the states of one colon, but there are {len(stages)}")
    if len(stages) == 1:
        options = {"force": args.force, "beside_colon": args.beside_colon}
        make_ahead(cfg.scene, cfg.sim, until, args.speed, args.max_time, **options)
        return
    failures = make_all_ahead(cfg.scene, cfg.sim, stages, until, args.speed, args.max_time, force=args.force)
    for failure in failures:
        say(failure)
    if failures:
        raise UsageError(f"the expert does not arrive in {len(failures)} of {len(stages)} patients")


def _env_cfg(args: SnapshotArguments) -> Any:
    """Return the task's configuration on the chosen device, checked, with what its switches put into the scene."""
    from arcgym.rl.device import choose_device
    from arcgym.utils.configclass import validate
    from arcgym.utils.hydra import apply_overrides
    from arcgym.utils.registry import load_cfg_from_registry

    try:
        cfg = load_cfg_from_registry(args.task, "env_cfg_entry_point")
        apply_overrides({"env": cfg}, args.overrides)
        validate(cfg, "env")
    except (TypeError, ValueError) as error:
        raise UsageError(str(error)) from error
    cfg.sim.device = choose_device(args.device)
    cfg.resolve()
    return cfg
