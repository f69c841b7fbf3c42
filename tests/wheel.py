# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""ARCGym as a pip user has it: a wheel in an environment of its own, run from another folder."""

from __future__ import annotations

import os
import site
import subprocess
import sys
import venv
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
HIDDEN = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "ARCGYM_ASSETS")
"""Environment variables that could lead to the checkout."""


@dataclass(frozen=True)
class WheelPython:
    """An interpreter with the wheel installed; the checkout is out of its sight."""

    executable: Path
    """The interpreter."""
    folder: Path
    """Working directory of the commands, outside the checkout."""

    def run(self, *arguments: str | Path, timeout: float = 300.0) -> subprocess.CompletedProcess[str]:
        """Run ``python <arguments>`` and return its output."""
        variables = {name: value for name, value in os.environ.items() if name not in HIDDEN}
        command = [str(self.executable), *map(str, arguments)]
        return subprocess.run(
            command, cwd=self.folder, env=variables, capture_output=True, text=True, timeout=timeout, check=False
        )

    def arcgym(self, *arguments: str | Path, timeout: float = 300.0) -> subprocess.CompletedProcess[str]:
        """Run ``arcgym <arguments>`` as installed by pip and return its output."""
        return self.run(self.executable.parent / "arcgym", *arguments, timeout=timeout)

    def check(self, code: str, timeout: float = 300.0) -> str:
        """Run a Python program, which must succeed, and return what it printed."""
        result = self.run("-c", code, timeout=timeout)
        assert result.returncode == 0, result.stderr
        return result.stdout


def install_wheel(base: Path) -> WheelPython:
    """Build the wheel and install it in ``base`` beside the packages of this environment, without the network."""
    pytest.importorskip("hatchling", reason="builds the wheel: pip install 'arcgym[dev]'")
    run_here("-m", "hatchling", "build", "--target", "wheel", "--directory", str(base))
    (wheel,) = base.glob("arcgym-*.whl")
    venv.create(base / "venv", with_pip=False)
    executable = base / "venv" / "bin" / "python"
    run_here("-m", "pip", "--python", str(executable), "install", "--quiet", "--no-deps", "--no-index", str(wheel))
    (own,) = (base / "venv").glob("lib/python*/site-packages")
    # Folders named by a .pth file are searched last, and .pth files inside them are not read: an editable install of
    # the checkout stays invisible.
    (own / "dependencies.pth").write_text("\n".join(site.getsitepackages()) + "\n")
    folder = base / "elsewhere"
    folder.mkdir()
    return WheelPython(executable, folder)


def run_here(*arguments: str) -> None:
    """Run a module of this environment in the checkout; its output is shown if it fails."""
    result = subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert result.returncode == 0, result.stdout + result.stderr
