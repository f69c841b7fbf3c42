# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Set up ``.venv`` in the checkout with the tested versions. Needs nothing but Python; does nothing when up to date.

On Linux without an NVIDIA driver torch comes from PyTorch's CPU index where that can be reached, which saves gigabytes.
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
import time
import urllib.error
import urllib.request
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VENV = ROOT / ".venv"
STAMP = VENV / ".installed"
EXTRAS = "dev,importer"
OLDEST_PYTHON = (3, 11)
CPU_INDEX = "https://download.pytorch.org/whl/cpu"


def main() -> None:
    """Install unless the stamp says that these very files were installed."""
    if sys.version_info < OLDEST_PYTHON:
        found, wanted = sys.version.split()[0], ".".join(map(str, OLDEST_PYTHON))
        sys.exit(f"Python {found} is too old, ARCGym needs {wanted} or newer. Name one: make PYTHON=python{wanted}")
    if STAMP.is_file() and STAMP.read_text() == fingerprint():
        print(f"{VENV} is up to date")
        return
    start = time.perf_counter()
    STAMP.unlink(missing_ok=True)
    if not python().is_file():
        print(f"creating {VENV}", flush=True)
        venv.create(VENV, with_pip=True)
    install()
    STAMP.write_text(fingerprint())
    print(f"{VENV} is ready after {time.perf_counter() - start:.0f} s")


def install() -> None:
    """Install the checkout in editable mode with all extras."""
    command = [str(python()), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    command += ["--constraint", "constraints.txt", "--editable", f".[{EXTRAS}]", *cpu_index()]
    print("installing:", " ".join(command), flush=True)
    if subprocess.run(command, cwd=ROOT).returncode != 0:
        sys.exit("pip could not install ARCGym; its message is above.")


def cpu_index() -> list[str]:
    """Return pip's arguments for PyTorch's CPU index, where it is wanted and can be reached."""
    if sys.platform != "linux" or shutil.which("nvidia-smi"):
        return []
    try:
        urllib.request.urlopen(f"{CPU_INDEX}/torch/", timeout=5).close()
    except (urllib.error.URLError, TimeoutError):
        return []
    return ["--extra-index-url", CPU_INDEX]


def python() -> Path:
    """Return the interpreter of the environment."""
    return VENV / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")


def fingerprint() -> str:
    """Return what the installation depends on: the interpreter and the two files that name packages."""
    files = b"".join((ROOT / name).read_bytes() for name in ("pyproject.toml", "constraints.txt"))
    return f"{sys.version_info.major}.{sys.version_info.minor} {hashlib.sha256(files).hexdigest()}\n"


if __name__ == "__main__":
    main()
