# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What a study is: settings that all its cells share, and the values that make its grid."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from arcgym.evaluation.suites import read_suites
from arcgym.utils.coerce import from_dict
from arcgym.utils.configclass import configclass, validate
from arcgym.utils.errors import UsageError
from arcgym.utils.string import did_you_mean
from arcgym.utils.validation import FieldError, require_at_least, require_positive

AXES = ("algorithm", "task", "robot", "seed", "num_envs", "minutes", "max_iterations")
"""Names that the grid may vary, beside paths ``env.…`` and ``agent.…``."""

GROUP_FIELDS = ("num_envs", "minutes", "max_iterations", "env", "agent", "after", "like", "overrides", "suites")
"""Names that the settings of one algorithm or one task may have."""

ROBOTS = "robots"
"""Name, in the settings of an algorithm, of further ones by robot."""


@configclass
class StudyCfg:
    """A grid of training runs. Each combination of the values in ``grid`` is a cell."""

    name: str = ""
    """Name of the study, and of its folder below ``logs/studies``."""

    algorithm: str = "ppo"
    """Agent where the grid does not vary it, such as ``ppo`` or ``sac``."""

    task: str = ""
    """Task where the grid does not vary it: a registered name, or a segment if ``robot`` is given."""

    robot: str | None = None
    """Robot, such as ``Magnetic``: makes ``ARC-<task>-<robot>`` of the task. None where tasks are named in full."""

    seed: int = 1
    """Seed where the grid does not vary it."""

    num_envs: int | None = None
    """Worlds of each cell; None takes the task's."""

    minutes: float | None = None
    """Minutes of learning of each cell; None learns for ``max_iterations``."""

    max_iterations: int | None = None
    """Updates of each cell. None is without end where ``minutes`` are given, and the agent's number where not."""

    evaluate: bool = True
    """Whether each world's first episode is run with the last policy. The table needs it."""

    suites: list[str] = []
    """Suites of :mod:`arcgym.evaluation` whose trials the last policies run once all seeds of a cell are finished, each
    seed its group of them, such as ``["left_colon", "ct"]``. A cell takes part in those that have its task; the results
    go to ``trials/<suite>/`` in the study's folder. None runs no trials."""

    env: dict[str, Any] = {}
    """Overrides of the environment's configuration in all cells, by path, such as ``{"lumen": "metric"}``."""

    agent: dict[str, Any] = {}
    """Overrides of the agent's configuration in all cells, by path."""

    tasks: dict[str, dict[str, Any]] = {}
    """Settings of single tasks by full name, on top of the above: ``num_envs``, ``minutes``, ``max_iterations``,
    ``env``, ``agent``, ``suites``."""

    algorithms: dict[str, dict[str, Any]] = {}
    """Settings of single algorithms, on top of those. ``after`` names an algorithm of the grid that must be finished
    first; the text ``{checkpoint}`` in a value stands for its last checkpoint with the same task and seed. ``like``
    names the agent of an algorithm that is another one with other settings. ``overrides`` is a list of texts as on the
    command line, for values that are given whole: ``["agent.algorithm.limits={tip_force: 0.2}"]``. ``robots`` has
    settings that are of one robot's tasks alone: ``{"Capsule": {"env": {"actions": {"capsule": …}}}}``."""

    grid: dict[str, list[Any]] = {}
    """Values by name: ``algorithm``, ``task``, ``robot``, ``seed``, ``num_envs``, ``minutes``, ``max_iterations``, or a
    path that starts with ``env.`` or ``agent.``. The last name varies fastest."""

    skip: list[dict[str, Any]] = []
    """Cells of the grid that are left out: those that have, for each name of one of these, its value or one of its
    values, as in ``[{robot: Capsule, seed: [2, 3]}]``. Names are those of the grid."""

    def validate_config(self) -> None:
        """Check numbers and names.

        Raises:
            FieldError: A value is out of range or a name is unknown.
        """
        require_at_least(self, 1, "num_envs", "max_iterations")
        require_at_least(self, -1, "seed")
        require_positive(self, "minutes")
        if not self.name or "/" in self.name or self.name.startswith("."):
            raise FieldError(self, "name", f"is '{self.name}', expected a name without '/' and no '.' in front.")
        for name, values in self.grid.items():
            if name not in AXES and not name.startswith(("env.", "agent.")):
                paths = "a path that starts with 'env.' or 'agent.'"
                raise FieldError(self, "grid", f"varies '{name}', expected {paths} or one of: {', '.join(AXES)}.")
            if not values:
                raise FieldError(self, "grid", f"gives '{name}' no values, expected one or more.")
        of_robots = [one for settings in self.algorithms.values() for one in settings.get(ROBOTS, {}).values()]
        groups = [*self.tasks.values(), *self.algorithms.values(), *of_robots]
        own = [one.get("suites", ()) for one in groups]
        known = read_suites()
        for name in [*self.suites, *(name for names in own for name in names)]:
            if name not in known:
                raise FieldError(self, "suites", f"has '{name}'. {did_you_mean(name, known)}")
        for name in (name for names in self.skip for name in names):
            if name not in ("algorithm", "task", "robot", "seed") and name not in self.grid:
                raise FieldError(self, "skip", f"names '{name}', expected names of the grid: {', '.join(self.grid)}.")
        self._check_groups("tasks", self.tasks, GROUP_FIELDS)
        self._check_groups("algorithms", self.algorithms, (*GROUP_FIELDS, ROBOTS))
        for settings in self.algorithms.values():
            self._check_groups("algorithms", settings.get(ROBOTS, {}), GROUP_FIELDS)

    def _check_groups(self, field: str, groups: dict[str, dict[str, Any]], known: Sequence[str]) -> None:
        """Raise if settings of ``field`` have a name that is not known."""
        for owner, settings in groups.items():
            for name in settings:
                if name not in known:
                    raise FieldError(self, field, f"gives '{owner}' '{name}'. {did_you_mean(name, known)}")


def find_study(name: str, folder: Path) -> Path:
    """Return the file of a study: a path, or the name of one in ``folder``.

    Raises:
        UsageError: There is none.
    """
    path = Path(name)
    if path.is_file():
        return path
    shipped = {file.stem: file for file in folder.glob("*.yaml")}
    if name in shipped:
        return shipped[name]
    raise UsageError(f"No study '{name}': expected a YAML file or the name of one. {did_you_mean(name, shipped)}")


def read_study(path: Path) -> StudyCfg:
    """Return the study that a YAML file describes; its name is the file's where it gives none.

    Raises:
        UsageError: The file is no YAML, or something in it is wrong.
    """
    try:
        values = yaml.safe_load(path.read_text())
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise UsageError(f"{path} is no YAML: {' '.join(str(error).split())}") from error
    if not isinstance(values, dict):
        raise UsageError(f"{path} holds {type(values).__name__}, expected the fields of a study.")
    cfg = StudyCfg(name=path.stem)
    for name in values:
        if name not in vars(cfg):
            raise UsageError(f"{path} has the field '{name}'. {did_you_mean(str(name), vars(cfg))}")
    try:
        from_dict(cfg, values)
        validate(cfg, "study")
    except (TypeError, ValueError) as error:
        raise UsageError(f"{path}: {error}") from error
    return cfg
