# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Starts the cells of a study through Hydra's multirun."""

from __future__ import annotations

import itertools
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import hydra
import yaml

from arcgym.rl.agent_checks import check_installed
from arcgym.studies.cell import Cell
from arcgym.studies.checks import check_cells, check_names
from arcgym.studies.grid import NAMED, is_left_out, make_cell, sweep_overrides
from arcgym.studies.run_cell import run_cell
from arcgym.studies.stopping import stopping_on_signals, was_stopped
from arcgym.studies.study_cfg import AXES, StudyCfg
from arcgym.studies.suite_trials import seeds_of
from arcgym.utils.coerce import from_dict, to_plain
from arcgym.utils.configclass import validate
from arcgym.utils.errors import UsageError
from arcgym.utils.files import write_whole
from arcgym.utils.string import did_you_mean

CONFIG = "study"
"""Name of the configuration that Hydra reads from the study's folder."""

EXTRAS = {"submitit_slurm": ("submitit", "slurm"), "submitit_local": ("submitit", "slurm"), "ray": ("ray", "ray")}
"""Package that a launcher needs and ARCGym's extra that brings it, beside ``pool`` and Hydra's ``basic``."""


@dataclass(frozen=True)
class LaunchOptions:
    """How the cells of a study are run."""

    launcher: str = "pool"
    """Name of Hydra's launcher: ``pool``, ``submitit_slurm``, ``submitit_local``, ``ray``, ``basic``."""

    devices: Sequence[str] = ("cpu",)
    """Devices of the launcher ``pool``."""

    per_device: int = 1
    """Cells at a time on each device."""

    stop_after: float | None = None
    """Minutes after which running cells are asked to stop with a checkpoint, and no more are started."""

    overrides: Sequence[str] = ()
    """Further overrides in Hydra's grammar, such as ``seed=1,2,3`` or ``hydra.launcher.partition=gpu``."""


def launch(cfg: StudyCfg, folder: Path, options: LaunchOptions) -> list[Cell]:
    """Run all cells that are not finished, wait for them, and return all cells.

    Cells that need another cell's checkpoint wait for the next pass; passes go on while one of them finishes something.

    Args:
        cfg: The study.
        folder: Folder of the study.
        options: Where and how.

    Raises:
        UsageError: A task is unknown, or a cell needs one that the grid does not have.
    """
    check_names(cfg)
    cells = all_cells(cfg, folder, options.overrides)
    check_cells(cells)
    if options.launcher in EXTRAS:
        package, extra = EXTRAS[options.launcher]
        check_installed(package, f"--launcher {options.launcher}", extra)
    values = to_plain(cfg) | {
        **_axes(cfg, options.overrides),
        "seeds": seeds_of(cells),
        "folder": str(folder),
        "device": None,
        "stop_at": None if options.stop_after is None else time.time() + 60.0 * options.stop_after,
    }
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / f"{CONFIG}.yaml", yaml.safe_dump(values, sort_keys=False).encode())
    waiting: set[str] = set()
    with stopping_on_signals():
        while True:
            _multirun(folder, [*sweep_overrides(cfg), *_launcher(options), *options.overrides])
            still = {cell.name for cell in cells if cell.read_state()["state"] == "waiting"}
            if not still or still == waiting or was_stopped():
                return cells
            waiting = still


def all_cells(cfg: StudyCfg, folder: Path, overrides: Sequence[str] = ()) -> list[Cell]:
    """Return the cells that the grid and the sweeps among ``overrides`` make.

    Raises:
        UsageError: An override cannot be read, names no field, or gives a list where one value belongs.
    """
    from hydra.core.override_parser.overrides_parser import OverridesParser
    from hydra.errors import HydraException
    from omegaconf import OmegaConf

    own = [text for text in overrides if not text.lstrip("+").startswith("hydra")]
    plain = to_plain(cfg) | _axes(cfg, overrides)
    try:
        parser = OverridesParser.create()
        by_key = {one.key_or_group: one for one in parser.parse_overrides([*sweep_overrides(cfg), *own])}
        choices = [
            [(key, parser.parse_override(f"x={text}").value()) for text in one.sweep_string_iterator()]
            if one.is_sweep_override()
            else [(key, one.value())]
            for key, one in by_key.items()
        ]
    except HydraException as error:
        raise UsageError(f"An override cannot be read: {' '.join(str(error).split())}") from error
    for key, choice in zip(by_key, choices, strict=True):
        _check_choices(key, [value for _, value in choice])
    found = []
    names = list(vars(cfg))
    for combination in itertools.product(*choices):
        values: Any = OmegaConf.create(plain)
        for key, value in combination:
            OmegaConf.update(values, key, value, force_add=True)
        plain_values: Any = OmegaConf.to_container(values, resolve=True)
        _check_types({name: plain_values[name] for name in names})
        if not is_left_out(plain_values):
            found.append(make_cell(plain_values, folder))
    return found


def _check_choices(key: str, values: Sequence[Any]) -> None:
    """Raise if an override names no field of a study, or gives a list where a cell has one value.

    Raises:
        UsageError: With what to write instead.
    """
    fields = vars(StudyCfg())
    if key.partition(".")[0] not in fields:
        raise UsageError(f"A study has no field '{key}'. {did_you_mean(key, fields)}")
    for value in values:
        if key in AXES and isinstance(value, (list, tuple, Mapping)):
            several = f"{key}={','.join(str(one) for one in value)}"
            raise UsageError(f"The override {key} is {value}, expected one value, or several as {several}.")


def _check_types(values: dict[str, Any]) -> None:
    """Raise if a field of a study has a value of another type, or one out of its range.

    Raises:
        UsageError: The field's name and what was expected.
    """
    checked = StudyCfg()
    try:
        from_dict(checked, values)
        validate(checked, "study")
    except (TypeError, ValueError) as error:
        raise UsageError(f"An override does not fit: {error}") from error


def _axes(cfg: StudyCfg, overrides: Sequence[str]) -> dict[str, list[str]]:
    """Return ``axes``, names that the grid or the command line varies, and ``fixed``, budgets given there as one value.

    Both come on top of the settings of algorithms and tasks. What is fixed is no part of a cell's name: the same cell
    goes on with more minutes.
    """
    own = {text.partition("=")[0].lstrip("+"): text for text in overrides}
    given = [name for name in own if name in AXES or name.startswith(("env.", "agent."))]
    names = [name for name in dict.fromkeys([*cfg.grid, *given]) if name not in NAMED]
    fixed = [name for name in names if name in AXES and name not in cfg.grid and "," not in own[name]]
    return {"axes": [name for name in names if name not in fixed], "fixed": fixed}


def _launcher(options: LaunchOptions) -> list[str]:
    """Return overrides that choose the launcher and keep Hydra quiet."""
    chosen = [f"hydra/launcher={options.launcher}", "hydra/hydra_logging=none", "hydra/job_logging=none"]
    if options.launcher == "pool":
        chosen.append(f"hydra.launcher.devices=[{','.join(repr(device) for device in options.devices)}]")
        chosen.append(f"hydra.launcher.per_device={options.per_device}")
    return chosen


def _multirun(folder: Path, overrides: Sequence[str]) -> None:
    """Call Hydra as from the command line."""
    words = ["arcgym study", "--multirun", "--config-dir", str(folder), "--config-name", CONFIG]
    words += ["hydra.output_subdir=null", f"hydra.sweep.dir={folder}/hydra", "hydra.sweep.subdir=${hydra.job.num}"]
    argv, sys.argv = sys.argv, [*words, *overrides]
    try:
        hydra.main(version_base="1.3", config_path=None)(run_cell)()
    finally:
        sys.argv = argv
