# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""``arcgym snapshots`` in a tube: what it makes, and how it answers mistakes."""

from __future__ import annotations

from pathlib import Path

import pytest
from tiny import write_tiny_colon

from arcgym.cli.main import main

TASK = ["snapshots", "--task", "ARC-Sigmoid-Capsule", "--device", "cpu"]


@pytest.fixture
def tube(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Override that puts a tube in the colon's place; the cache is empty."""
    monkeypatch.setenv("ARCGYM_CACHE", str(tmp_path / "cache"))
    return f"env.scene.colon.usd_path={write_tiny_colon(tmp_path)}"


def test_it_makes_the_states_up_to_the_segment_asked_for(tube: str, tmp_path: Path, capsys) -> None:
    assert main([*TASK, tube, "--until", "descending", "--speed", "0.06"]) == 0
    assert "rectum, sigmoid, descending after" in capsys.readouterr().err
    assert len(list((tmp_path / "cache" / "start_states").rglob("capsule-paper-*.npz"))) == 1


def test_states_are_those_of_the_effects_that_were_asked_for(tube: str, tmp_path: Path, capsys) -> None:
    for effects in ([], ["env.clinical=[tissue]"]):
        assert main([*TASK, tube, *effects, "--until", "rectum"]) == 0
    made = {path.name.split("-")[1] for path in (tmp_path / "cache" / "start_states").rglob("capsule-*.npz")}
    assert made == {"paper", "clinical"}


def test_a_drive_that_ends_early_exits_with_status_2_and_keeps_its_states(tube: str, tmp_path: Path, capsys) -> None:
    with pytest.raises(SystemExit) as end:
        main([*TASK, tube, "--max_time", "0.2"])
    error = capsys.readouterr().err
    assert end.value.code == 2 and "not there after 0.2 s" in error and "there are states of rectum" in error
    assert list((tmp_path / "cache" / "start_states").rglob("*.npz"))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--until", "sigmod"], "segment 'sigmod' is not in"),
        (["--speed", "0"], "--speed is 0, expected more than 0"),
        (["--max_time", "-1"], "--max_time is -1, expected more than 0"),
        (["env.scene.endoscope.actuators.tip.force_limitt=1"], "force_limit"),
        (["--untill", "sigmoid"], "Did you mean '--until'"),
    ],
)
def test_a_mistake_is_answered_in_one_line(tube: str, words: list[str], message: str, capsys) -> None:
    with pytest.raises(SystemExit) as end:
        main([*TASK, tube, *words])
    lines = [line for line in capsys.readouterr().err.splitlines() if "error:" in line]
    assert end.value.code == 2 and len(lines) == 1 and message in lines[0]


def test_every_patient_of_a_list_has_its_states_made(tube: str, tmp_path: Path, capsys) -> None:
    for name, segments in (("whole", ("rectum", "sigmoid")), ("short", ("rectum",))):
        (tmp_path / name).mkdir()
        write_tiny_colon(tmp_path / name, segments=segments)
    folder = f"env.scene.colon.usd_path=[{tmp_path}/short/colon.usda,{tmp_path}/whole/colon.usda]"
    with pytest.raises(SystemExit):
        main([*TASK, folder, "--until", "sigmoid", "--speed", "0.06"])
    error = capsys.readouterr().err
    assert "patients 1 to 2 of 2: 1 without start states" in error and "does not arrive in 1 of 2 patients" in error
    assert f"{tmp_path}/short/colon.usda: there is no segment 'sigmoid'" in error.splitlines()
    made = list((tmp_path / "cache" / "start_states").rglob("*.npz"))
    assert [path.parent.name for path in made] == ["whole"]
    with pytest.raises(SystemExit):
        main([*TASK, folder, "--until", "sigmoid"])
    assert "patients 1 to 2 of 2: 0 without start states" in capsys.readouterr().err
