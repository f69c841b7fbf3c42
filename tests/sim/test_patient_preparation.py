# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Many patients are prepared by processes, once; few are left to the environment."""

from __future__ import annotations

from pathlib import Path

import pytest
from tiny import write_tiny_colon

from arcgym.assets import ColonCfg
from arcgym.sim import patient_preparation
from arcgym.sim.patient_preparation import prepare_patients
from arcgym.sim.patient_walls import patient_walls
from arcgym.utils.class_type import construct


@pytest.fixture
def cfg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ColonCfg:
    monkeypatch.setenv("ARCGYM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(patient_preparation, "FEW", 3)
    monkeypatch.setattr(patient_preparation.os, "sched_getaffinity", lambda _: {0, 1}, raising=False)
    folders = [tmp_path / f"colon_{number}" for number in range(4)]
    for folder in folders:
        folder.mkdir()
    return ColonCfg(usd_path=[str(write_tiny_colon(folder)) for folder in folders])


def made(tmp_path: Path, kind: str) -> int:
    return len(list((tmp_path / "cache" / kind).glob("*")))


def test_what_processes_make_is_what_the_environment_takes(cfg: ColonCfg, tmp_path: Path) -> None:
    prepare_patients(cfg)
    before = [made(tmp_path, kind) for kind in ("patients", "walls", "prepared")]
    assert before[0] == 4 and before[1] >= 1 and before[2] == 4  # walls of like patients share a file
    patient_walls(construct(cfg))
    assert [made(tmp_path, kind) for kind in ("patients", "walls", "prepared")] == before


def test_it_is_done_once_for_each_tissue(cfg: ColonCfg, monkeypatch: pytest.MonkeyPatch) -> None:
    prepared = []
    monkeypatch.setattr(patient_preparation, "_prepare", lambda cfg, paths, _: prepared.append(len(paths)) or paths)
    prepare_patients(cfg)
    prepare_patients(cfg)
    prepare_patients(cfg.replace(material="in_situ"))
    assert prepared == [4, 4]


def test_few_patients_are_left_to_the_environment(cfg: ColonCfg, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patient_preparation, "_prepare", lambda *_: pytest.fail("processes for three patients"))
    prepare_patients(cfg.replace(usd_path=cfg.usd_path[:3]))


def test_what_cannot_be_prepared_is_left_to_the_environment(cfg: ColonCfg, tmp_path: Path) -> None:
    Path(cfg.usd_path[0]).write_text("#usda 1.0\n")
    prepare_patients(cfg)
    assert made(tmp_path, "prepared") == 2  # the other process's
