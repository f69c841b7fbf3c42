# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The command that validates stages: exit status, lines, JSON."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from tiny import write_tiny_colon

from arcgym.anatomy.generator.patients import PATIENTS
from arcgym.cli.main import main

ROOT = Path(__file__).resolve().parents[2]


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "scripts/tools/validate_colon.py"), *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)


def test_one_good_and_one_missing_stage(tmp_path: Path) -> None:
    good, missing = write_tiny_colon(tmp_path), tmp_path / "missing.usda"
    result = run(good, missing, "--json", "--no-physics")
    report = json.loads(result.stdout.splitlines()[-1])["stages"]
    assert result.returncode == 1
    assert [(stage["path"], stage["ok"]) for stage in report] == [(str(good), True), (str(missing), False)]
    assert set(report[0]["checks"][0]) == {"name", "value", "bound", "ok"}
    assert "no such file" in report[1]["checks"][0]["name"]


def test_a_folder_stands_for_the_stages_in_its_folders(tmp_path: Path, capsys) -> None:
    for name in "ab":
        (tmp_path / name).mkdir()
        write_tiny_colon(tmp_path / name)
    assert main(["validate", str(tmp_path), "--no-physics", "--json"]) == 0
    report = json.loads(capsys.readouterr().out.splitlines()[-1])["stages"]
    assert [stage["path"] for stage in report] == [str(tmp_path / name / "colon.usda") for name in "ab"]
    (tmp_path / "a" / "empty").mkdir()
    with pytest.raises(SystemExit):
        main(["validate", str(tmp_path / "a" / "empty")])
    assert "no stages in" in capsys.readouterr().err


@pytest.mark.slow
def test_committed_stages_pass_with_physics() -> None:
    result = run(*(ROOT / "assets/usd" / name / "colon.usda" for name in PATIENTS), "--json")
    assert result.returncode == 0, result.stdout
    names = [check["name"] for check in json.loads(result.stdout.splitlines()[-1])["stages"][0]["checks"]]
    assert sum(name.startswith("physics") for name in names) == 3
