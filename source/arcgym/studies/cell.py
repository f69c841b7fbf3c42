# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""One training run of a study: its settings, its folder, and the command that runs it."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from arcgym.rl.run_folder import find_newest_checkpoint
from arcgym.utils.files import write_whole

CELL_FILE = "cell.json"
"""Settings and state of a cell."""

LOG_FILE = "log.txt"
"""What the cell's processes print."""

ENDLESS = 10**9
"""Iterations of a cell that ends by time."""

STATES = ("finished", "failed", "stopped", "waiting", "running", "pending")
"""``stopped`` goes on at the next start; ``waiting`` is for another cell's checkpoint."""


@dataclass(frozen=True)
class Cell:
    """A cell of a study."""

    study: Path
    """Folder of the study."""

    task: str
    """Registered name of the task."""

    algorithm: str
    """Agent."""

    seed: int
    """Seed."""

    axes: dict[str, Any] = field(default_factory=dict)
    """What else the grid varies, by name."""

    num_envs: int | None = None
    """Worlds; None takes the task's."""

    minutes: float | None = None
    """Minutes of learning; None learns for ``max_iterations``."""

    max_iterations: int | None = None
    """Updates; None is without end with ``minutes``, else the agent's number."""

    evaluate: bool = True
    """Whether the last policy is evaluated."""

    after: str | None = None
    """Algorithm whose cell must be finished first."""

    overrides: tuple[str, ...] = ()
    """Overrides ``env.…=…`` and ``agent.…=…``."""

    like: str | None = None
    """Registered agent, where ``algorithm`` is a name of the study's own."""

    suites: tuple[str, ...] = ()
    """Suites whose trials the last policy runs, those of them that have the task."""

    @property
    def name(self) -> str:
        """Name of the cell, which is that of its folder."""
        return self.name_with(self.seed)

    def name_with(self, seed: Any) -> str:
        """Return the name of this cell with another text as its seed, such as ``1+2+3`` of several cells together."""
        task = self.task.removeprefix("ARC-").lower()
        varied = [f"{path.rpartition('.')[2]}={value}" for path, value in self.axes.items()]
        return re.sub(r"[^\w.=+-]+", "_", "_".join([task, self.algorithm, f"seed{seed}", *varied]))

    @property
    def folder(self) -> Path:
        """Folder of the cell."""
        return self.study / self.name

    @property
    def runs(self) -> list[Path]:
        """Folders of the parts that the run was resumed in, in order."""
        return sorted(self.folder.glob("run_*"), key=lambda path: int(path.name.removeprefix("run_")))

    def checkpoint(self) -> Path | None:
        """Return the last checkpoint, or None before the first."""
        found = [path for run in reversed(self.runs) if (path := find_newest_checkpoint(run)) is not None]
        return found[0] if found else None

    def teacher(self) -> Cell | None:
        """Return the cell that must be finished first, or None."""
        if self.after is None:
            return None
        return Cell(self.study, self.task, self.after, self.seed, self.axes)

    def settings(self) -> dict[str, Any]:
        """Return what makes two cells the same run, as plain values."""
        plain = {name: value for name, value in asdict(self).items() if name not in ("study", "evaluate", "suites")}
        return json.loads(json.dumps(plain))

    def command(self, device: str | None) -> list[str]:
        """Return the command that starts this cell, or goes on with it."""
        words = [sys.executable, "-m", "arcgym", "train", "--task", self.task]
        words += ["--agent", self.like or self.algorithm]
        words += ["--seed", str(self.seed), "--log_dir", str(self.folder / f"run_{len(self.runs) + 1}")]
        iterations = self.max_iterations or (ENDLESS if self.minutes else None)
        checkpoint = self.checkpoint()
        if checkpoint is not None:
            words += ["--resume", "--checkpoint", str(checkpoint)]
            done = int(checkpoint.stem.rpartition("_")[2]) + 1
            iterations = None if iterations is None else max(iterations - done, 1)
        options = {
            "--num_envs": self.num_envs,
            "--max_minutes": self.minutes,
            "--max_iterations": iterations,
            "--device": device,
        }
        words += [word for name, value in options.items() if value is not None for word in (name, str(value))]
        words += ["--evaluate"] if self.evaluate else []
        return words + [self._with_checkpoint(text) for text in self.overrides]

    def read_state(self) -> dict[str, Any]:
        """Return what :meth:`write_state` wrote last; ``{"state": "pending"}`` before."""
        path = self.folder / CELL_FILE
        return json.loads(path.read_text()) if path.is_file() else {"state": "pending"}

    def write_state(self, state: str, **more: Any) -> None:
        """Write the cell's settings and state, one of :data:`STATES`, to its folder."""
        self.folder.mkdir(parents=True, exist_ok=True)
        contents = {"state": state, "settings": self.settings(), **more}
        write_whole(self.folder / CELL_FILE, json.dumps(contents, indent=1).encode())

    def _with_checkpoint(self, text: str) -> str:
        """Return an override with the teacher's checkpoint written into it."""
        teacher = self.teacher()
        return text if teacher is None else text.replace("{checkpoint}", str(teacher.checkpoint()))


def read_cells(study: Path) -> list[Cell]:
    """Return the cells that lie in a study's folder, sorted by name."""
    cells = []
    for path in sorted(study.glob(f"*/{CELL_FILE}")):
        settings = json.loads(path.read_text())["settings"]
        cells.append(Cell(study=study, **{**settings, "overrides": tuple(settings["overrides"])}))
    return cells
