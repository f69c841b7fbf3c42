# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The command line of the fidelity benchmark and its table."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "benchmarks" / "fidelity.py"


def call(*arguments: str, flags: tuple[str, ...] = ()) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *flags, str(SCRIPT), *arguments], capture_output=True, text=True, timeout=200
    )


def test_help_needs_no_heavy_imports() -> None:
    result = call("--help", flags=("-X", "importtime"))
    assert result.returncode == 0, result.stderr
    imported = {line.split("|")[-1].strip() for line in result.stderr.splitlines()}
    assert not {"torch", "warp", "newton", "mujoco"} & imported


def test_unknown_row_is_refused_with_the_known_ones(fidelity: Any) -> None:
    with pytest.raises(ValueError, match=r"\['jelly'\]; the rows are .*cantilever_small, "):
        fidelity.choose("jelly,torsion", quick=False)


def test_row_names_are_unique(fidelity: Any) -> None:
    names = [name for check in fidelity.CHECKS for name in check.rows]
    assert len(names) == len(set(names))


def test_a_row_out_of_bound_gives_status_1_and_stays_in_the_json(
    fidelity: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from fidelity_checks.table import CHECKS, Check, relative

    broken = Check(("broken",), lambda run: [relative("broken", 1.2, 1.0, 0.1)], quick=True)
    monkeypatch.setattr(fidelity, "CHECKS", [*CHECKS, broken])
    monkeypatch.setattr(sys, "argv", ["fidelity.py", "--rows", "broken", "--json"])
    with pytest.raises(SystemExit) as ended:
        fidelity.main()
    assert ended.value.code == 1
    (row,) = json.loads(capsys.readouterr().out.splitlines()[-1])["rows"]
    assert set(row) == {"name", "value", "reference", "error", "bound", "ok"}
    assert row["name"] == "broken" and not row["ok"]


def test_an_error_that_is_not_finite_is_not_ok() -> None:
    from fidelity_checks.table import relative

    assert relative("a", 1.01, 1.0, 0.02).ok
    assert not relative("a", 0.97, 1.0, 0.02).ok
    assert not relative("a", float("nan"), 1.0, 0.02).ok
