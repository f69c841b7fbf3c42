# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What is wrong with a study, before any of its cells starts."""

from __future__ import annotations

from collections.abc import Sequence

import gymnasium

from arcgym.studies.cell import Cell
from arcgym.studies.study_cfg import ROBOTS, StudyCfg
from arcgym.utils.errors import UsageError
from arcgym.utils.registry import CFG_SUFFIX, list_tasks
from arcgym.utils.string import did_you_mean

OWN_FIELDS = {
    "agent.seed": "seed",
    "env.seed": "seed",
    "agent.max_iterations": "max_iterations",
    "agent.max_minutes": "minutes",
    "env.scene.num_envs": "num_envs",
}
"""Fields of a study that a cell's command gives as flags, by the path of the field that they set."""


def check_cells(cells: Sequence[Cell]) -> None:
    """Raise unless all tasks exist, names differ, and cells that others need are there; what began goes on as it was.

    Raises:
        UsageError: The first thing that is wrong.
    """
    names = [cell.name for cell in cells]
    tasks = list_tasks(prefix="")
    for cell in cells:
        if cell.task not in tasks:
            raise UsageError(f"The study has the task '{cell.task}'. {did_you_mean(cell.task, tasks)}")
        _check_agent(cell)
        _check_own_fields(cell)
        if names.count(cell.name) > 1:
            raise UsageError(f"The study has the cell '{cell.name}' {names.count(cell.name)} times, expected once.")
        teacher = cell.teacher()
        if teacher is not None and teacher.name not in names:
            raise UsageError(f"The cell '{cell.name}' comes after '{teacher.name}', which the grid does not have.")
        _check_settings(cell)


def _check_agent(cell: Cell) -> None:
    """Raise if the cell's task has no such agent."""
    given, known = cell.like or cell.algorithm, _agents_of(cell.task)
    if given not in known:
        names = {name for name in known if not name.endswith(CFG_SUFFIX)}
        raise UsageError(f"The study has the algorithm '{given}'. {did_you_mean(given, names)}")


def _check_own_fields(cell: Cell) -> None:
    """Raise if an override gives what the cell's own command gives: that stands, and the override would do nothing."""
    for text in cell.overrides:
        own = OWN_FIELDS.get(text.lstrip("+").partition("=")[0])
        if own is not None:
            raise UsageError(
                f"The study gives {text} to '{cell.name}', which takes it from '{own}': give or vary that."
            )


def check_names(cfg: StudyCfg) -> None:
    """Raise if settings are of a task, an algorithm or a robot that is not registered, and would be of no cell.

    Raises:
        UsageError: The first such name.
    """
    tasks = list_tasks(prefix="")
    agents = {name for task in tasks for name in _agents_of(task)}
    robots = {task.rpartition("-")[2] for task in tasks if not task.endswith("-Play")}
    like = {name for name, settings in cfg.algorithms.items() if settings.get("like")}
    of_robots = {robot for settings in cfg.algorithms.values() for robot in settings.get(ROBOTS, {})}
    for what, given, known in (
        ("task", cfg.tasks, tasks),
        ("algorithm", cfg.algorithms, agents | like),
        ("robot", of_robots, robots),
    ):
        for name in given:
            if name not in known:
                raise UsageError(f"The study has settings of the {what} '{name}'. {did_you_mean(name, sorted(known))}")


def _agents_of(task: str) -> set[str]:
    """Return the agents of a task; ``sac`` stands for ``rsl_rl_sac_cfg_entry_point``."""
    keys = [key for key in gymnasium.registry[task].kwargs if key.endswith(CFG_SUFFIX) and key[:4] != "env_"]
    return {key.removesuffix(CFG_SUFFIX).removeprefix("rsl_rl").lstrip("_") or "ppo" for key in keys} | set(keys)


def _check_settings(cell: Cell) -> None:
    """Raise if a cell was begun with other settings; more time or iterations are no others."""
    began = cell.read_state().get("settings")
    if began is None or not cell.runs:
        return
    now = cell.settings()
    for name in now:
        if name not in ("minutes", "max_iterations") and began.get(name) != now[name]:
            raise UsageError(
                f"The cell '{cell.name}' was begun with other settings: {name} {began.get(name)}, now {now[name]}. "
                f"Choose another --folder, or remove {cell.folder}."
            )
