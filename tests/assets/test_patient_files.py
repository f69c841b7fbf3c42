# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Stages that a configuration names: one, lists, folders, splits of populations."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from arcgym.assets.patient_files import find_stages, named_colon
from arcgym.utils import populations
from arcgym.utils.paths import assets_dir
from arcgym.utils.populations import register_population


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three patients, of which ``empty`` has no stage, and a file."""
    for name in ("b", "a", "empty"):
        (tmp_path / name).mkdir()
    for name in ("a/colon.usda", "a/colon.usdc", "b/colon.usdc", "notes.txt"):
        (tmp_path / name).write_text("")
    return tmp_path


@pytest.fixture
def population(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[tuple[str, int | None]]]:
    """A population of three patients a split; what was asked for."""
    asked = []

    def resolve(split: str, count: int | None) -> list[Path]:
        if split != "train":
            raise ValueError(f"There is no split '{split}'. Available: train.")
        asked.append((split, count))
        return [Path(f"{split}_{k}.usda") for k in range(3)][:count]

    monkeypatch.setattr(populations, "POPULATIONS", {})
    register_population("people", resolve)
    yield asked


def test_words_of_a_command_line_name_colons(folder: Path) -> None:
    assert named_colon("colon_1") == named_colon("colon_1/colon.usda") == "colon_1/colon.usda"
    for path in ("a", "a/colon.usdc", "b/colon.usdc", "b"):
        expected = "a/colon.usda" if path == "a" else path
        assert named_colon(str(folder / path)) == str(folder / expected)
    assert named_colon("population:20000*0.8") == "population:20000*0.8"
    with pytest.raises(ValueError, match="no colon 'colon_11', which is no stage file. Did you mean 'colon_1'"):
        named_colon("colon_11")


def test_a_folder_stands_for_the_stages_in_its_folders(folder: Path) -> None:
    assert find_stages(str(folder)) == [folder / "a/colon.usda", folder / "b/colon.usdc"]
    assert find_stages(str(folder / "b")) == [folder / "b/colon.usdc"]
    assert find_stages([str(folder / "b/colon.usdc"), str(folder / "a")]) == [
        folder / "b/colon.usdc",
        folder / "a/colon.usda",
    ]


def test_the_first_patients_are_taken(folder: Path) -> None:
    assert find_stages(str(folder), 1) == [folder / "a/colon.usda"]
    with pytest.raises(ValueError, match="num_patients is 3, but .* has 2 patients"):
        find_stages(str(folder), 3)


def test_a_split_is_asked_for_as_many_as_wanted(population: list[tuple[str, int | None]]) -> None:
    assert find_stages("people:train", 2) == [Path("train_0.usda"), Path("train_1.usda")]
    assert population == [("train", 2)]
    assert len(find_stages([str(assets_dir() / "colon_1/colon.usda"), "people:train"], 3)) == 3
    assert population == [("train", 2)] * 2
    with pytest.raises(ValueError, match="no split 'test'"):
        find_stages("people:test")


@pytest.mark.parametrize(
    ("names", "message"),
    [
        ([], "an empty list"),
        ("peeple:train", "no population 'peeple'.*Did you mean 'people'"),
        ("{folder}/empty", "no stages in .*empty, expected a colon.usda"),
        (["{folder}/a", "{folder}/a/colon.usda"], "a/colon.usda twice"),
    ],
)
@pytest.mark.usefixtures("population")
def test_what_names_no_patients_is_refused(folder: Path, names: str | list[str], message: str) -> None:
    filled = names.format(folder=folder) if isinstance(names, str) else [name.format(folder=folder) for name in names]
    with pytest.raises(ValueError, match=message):
        find_stages(filled)


def test_single_patients_of_a_population_are_made_together(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def resolve(split: str, count: int | None) -> list[Path]:
        asked.append(split)
        return [Path(f"{seed}.usda") for seed in split.split(",")]

    monkeypatch.setattr(populations, "POPULATIONS", {"people": resolve})
    stage = folder / "b/colon.usdc"
    assert find_stages(["people:7", "people:9", str(stage), "people:8"]) == [
        Path("7.usda"),
        Path("9.usda"),
        stage,
        Path("8.usda"),
    ]
    assert asked == ["7,9", "8"]


@pytest.mark.usefixtures("population")
def test_a_name_is_registered_once() -> None:
    for name in ("people", "c"):
        with pytest.raises(ValueError, match=f"cannot be called '{name}'"):
            register_population(name, "module:function")


def test_a_split_that_a_resolver_looks_up_in_vain_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(populations, "POPULATIONS", {})
    register_population("mine", lambda split, count: {"train": []}[split])
    with pytest.raises(ValueError, match="Population 'mine' has no split 'tset'"):
        find_stages("mine:tset")


def test_registering_a_population_loads_no_torch() -> None:
    """A package that does so when tasks are listed keeps the list fast."""
    code = "import sys, arcgym.utils.populations; sys.exit('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], timeout=60).returncode == 0


def test_two_hundred_patients_by_seed_are_no_file_name(population: list[tuple[str, int | None]]) -> None:
    """Made together they are one entry of 1200 letters, for which the system has an error of its own."""
    with pytest.raises(ValueError, match="no split '20000,20001,"):
        find_stages([f"people:{seed}" for seed in range(20000, 20200)])
