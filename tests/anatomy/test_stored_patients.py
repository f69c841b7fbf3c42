# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Stages of the population's splits: what is there is taken, what is missing is generated once."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from arcgym.anatomy.generator import stored_patients
from arcgym.anatomy.generator.stored_patients import population_stages, stage_of, store_folder
from arcgym.assets.patient_files import find_stages

PYTHON = sys.executable
WORKER = """
import os, sys
from pathlib import Path
(folder,) = sys.argv[3:]
while record := os.read(0, 32):
    seed = int(record)
    if seed == {bad}:
        sys.exit("Traceback\\nAnatomyError: seed 10001 gave no usable anatomy")
    out = Path(folder) / f"patient_{{seed:05d}}"
    out.mkdir(parents=True)
    (out / "colon.usda").write_text(str(seed))
"""


def test_a_folder_is_of_one_version_and_one_grid() -> None:
    assert store_folder().name == "generator_4_160x14"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache, and a generator that writes its seed."""
    monkeypatch.setenv("ARCGYM_CACHE", str(tmp_path))
    use_worker(tmp_path, monkeypatch)
    return store_folder()


def use_worker(folder: Path, monkeypatch: pytest.MonkeyPatch, bad: int = -1) -> None:
    """Put a script in the interpreter's place, which gets the arguments of the real one."""
    script = folder / "python"
    script.write_text(f"#!{PYTHON}\n{WORKER.format(bad=bad)}")
    script.chmod(0o755)
    monkeypatch.setattr(stored_patients.sys, "executable", str(script))


def test_the_first_patients_of_a_split_are_generated_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stages = find_stages("population:validation", 3)
    assert stages == [stage_of(folder, seed) for seed in (10000, 10001, 10002)]
    assert [stage.read_text() for stage in stages] == ["10000", "10001", "10002"]
    monkeypatch.setattr(stored_patients, "_generate", lambda folder, seeds: pytest.fail(f"{seeds} made again"))
    assert population_stages("validation", 2) == stages[:2]


def test_a_patient_that_cannot_be_generated_is_told(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_worker(tmp_path, monkeypatch, bad=10001)
    with pytest.raises(ValueError, match="cannot be generated: AnatomyError: seed 10001 gave no usable anatomy"):
        population_stages("validation", 2)


@pytest.mark.parametrize(
    ("split", "count", "message"),
    [
        ("train", None, "population:train has 10000 patients.*env.scene.colon.num_patients"),
        ("validation", 101, "num_patients is 101, but population:validation has 100"),
        ("valid", 1, "Unknown split 'valid'.*validation"),
    ],
)
def test_what_a_split_does_not_have_is_refused(folder: Path, split: str, count: int | None, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        population_stages(split, count)
    assert not folder.exists()


def test_the_program_makes_what_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    monkeypatch.setattr(
        "arcgym.anatomy.generator.output.make_to_folder", lambda spec, out: made.append((spec.seed, out))
    )
    stage_of(tmp_path, 7).parent.mkdir(parents=True)
    stage_of(tmp_path, 7).write_text("")
    stored_patients.main(str(tmp_path), "7", "8")
    assert made == [(8, stage_of(tmp_path, 8).parent)]


def test_patients_with_less_gas_are_not_widened_for_a_head(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They are what a scope has to push apart, and the same as before there was such a check."""
    made = []
    monkeypatch.setattr("arcgym.anatomy.generator.output.make_to_folder", lambda spec, out: made.append(spec))
    stored_patients.main(str(tmp_path), "8", "8*0.7")
    assert [(spec.inflation, spec.head_room) for spec in made] == [(1.0, True), (0.7, False)]


def test_single_patients_are_named_by_their_seed(folder: Path) -> None:
    assert find_stages(["population:20007", "population:10000"]) == [stage_of(folder, 20007), stage_of(folder, 10000)]
    less_gas = folder / "patient_20007_gas_0.8" / "colon.usda"
    assert stage_of(folder, "20007*0.8") == less_gas
    with pytest.raises(ValueError, match="Seed 15000 is in no split.*test 20000 to 20199"):
        find_stages("population:15000")


def test_a_worker_whose_parent_is_gone_takes_no_more_patients(monkeypatch) -> None:
    parents = iter([7, 7, 1])  # as the worker starts, before the first patient, and before the second
    monkeypatch.setattr(stored_patients.os, "getppid", lambda: next(parents))
    monkeypatch.setattr(stored_patients.os, "read", lambda file, size: b"20001")
    assert list(stored_patients._next_of_all()) == ["20001"]
