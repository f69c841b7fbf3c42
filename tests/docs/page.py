# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Code blocks of a page, written to a folder and run there with the installed wheel, as a reader would."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import tomllib
from pathlib import Path

from wheel import WheelPython

ROOT = Path(__file__).parents[2]


class Page:
    """A page of the documentation, acted out in a folder.

    A Python block whose first line is a comment with a path goes to that file; the others are run in their order.
    """

    def __init__(self, path: str, folder: Path, wheel: WheelPython):
        text = (ROOT / path).read_text()
        self.folder, self.wheel = folder, wheel
        self.blocks = re.findall(r"^```(\w+)\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
        self.files = dict(found.groups() for code in self.of("python") if (found := _FILE.fullmatch(code)))
        for name, code in self.files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(code)
        self._install([tomllib.loads(block) for block in self.of("toml")])

    def of(self, language: str) -> list[str]:
        """Blocks of a language."""
        return [code for kind, code in self.blocks if kind == language]

    def commands(self) -> list[str]:
        """Lines of the shell blocks, without comments."""
        lines = "".join(self.of("bash")).splitlines()
        return [shlex.join(words) for line in lines if (words := shlex.split(line, comments=True))]

    def command(self, start: str) -> str:
        """The only command that begins with ``start``."""
        (found,) = [line for line in self.commands() if line.startswith(start)]
        return found

    def run(self, command: str, timeout: float = 500.0) -> str:
        """Run a command in the folder and return what it printed; the test fails if it does."""
        words = shlex.split(command.replace("$PWD", str(self.folder)))
        python = self.wheel.executable
        program = {"python": [str(python)], "arcgym": [str(python), str(python.parent / "arcgym")]}[words[0]]
        result = subprocess.run(
            [*program, *words[1:]],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": str(self.folder)},
            capture_output=True,
            text=True,
            timeout=timeout,
        )
        assert result.returncode == 0, f"{command}\n{result.stdout}\n{result.stderr}"
        return result.stdout + result.stderr

    def run_python(self) -> None:
        """Run the Python blocks that belong to no file."""
        for code in self.of("python"):
            if not _FILE.fullmatch(code):
                (self.folder / "_block.py").write_text(code)
                self.run("python _block.py")

    def _install(self, projects: list[dict]) -> None:
        """Declare the entry points as pip would on installing the package."""
        for project in projects:
            for group, names in project["project"]["entry-points"].items():
                info = self.folder / f"{next(iter(names))}-0.1.dist-info"
                info.mkdir()
                (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {next(iter(names))}\nVersion: 0.1\n")
                lines = [f"{name} = {module}" for name, module in names.items()]
                (info / "entry_points.txt").write_text("\n".join([f"[{group}]", *lines, ""]))


_FILE = re.compile(r"# (\S+\.py)\n(.*)", re.DOTALL)
