# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The command line of the fidelity benchmark and its table."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from arcgym.benchmarks.fidelity import table
from arcgym.benchmarks.fidelity.rows import Check, Run, relative
from arcgym.cli.main import main

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


def test_unknown_row_is_refused_with_the_known_ones(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["bench", "fidelity", "--rows", "jelly,torsion"])
    assert ended.value.code == 2
    message = capsys.readouterr().err
    assert "['jelly']; the rows are cantilever_small, " in message


def test_row_names_are_unique() -> None:
    names = [name for check in table.TABLE for name in check.rows]
    assert len(names) == len(set(names))


def test_listing_rows_needs_no_heavy_imports() -> None:
    result = call("--list", flags=("-X", "importtime"))
    assert result.stdout.split() == [name for check in table.TABLE for name in check.rows]
    imported = {line.split("|")[-1].strip() for line in result.stderr.splitlines()}
    assert not {"torch", "warp", "newton", "mujoco"} & imported


def test_every_line_of_the_table_names_a_function() -> None:
    for check in table.TABLE:
        assert callable(check.load()), check.function


def test_a_row_out_of_bound_gives_status_1_and_stays_in_the_json(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = Check(("broken",), "none:none")
    monkeypatch.setattr(Check, "measure", lambda self, run: [relative("broken", 1.2, 1.0, 0.1)])
    monkeypatch.setattr(table, "TABLE", (*table.TABLE, broken))
    assert main(["bench", "fidelity", "--rows", "broken", "--json"]) == 1
    (row,) = json.loads(capsys.readouterr().out.splitlines()[-1])["rows"]
    assert set(row) == {"name", "value", "reference", "error", "bound", "ok", "unit", "relative", "note"}
    assert row["name"] == "broken" and not row["ok"]


def test_a_function_that_gives_other_rows_than_the_table_names_is_refused(
    monkeypatch: pytest.MonkeyPatch, run: Run
) -> None:
    monkeypatch.setattr(Check, "load", lambda self: lambda run: [relative("other", 1.0, 1.0, 0.1)])
    with pytest.raises(RuntimeError, match=r"the rows \('other',\); the table expects \('mine',\)"):
        Check(("mine",), "module:name").measure(run)


def test_an_error_that_is_not_finite_is_not_ok() -> None:
    assert relative("a", 1.01, 1.0, 0.02).ok
    assert not relative("a", 0.97, 1.0, 0.02).ok
    assert not relative("a", float("nan"), 1.0, 0.02).ok
