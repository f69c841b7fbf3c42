# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Patients and their walls come from the cache as they were made, and are made anew where something changed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tiny import write_tiny_colon

from arcgym.assets import ColonCfg, patient_cache
from arcgym.assets.colon import Colon
from arcgym.assets.patient_cache import stage_content
from arcgym.sim import patient_walls as walls_module
from arcgym.sim.patient_walls import patient_walls


@pytest.fixture
def paths(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Two tubes, and an empty cache folder."""
    monkeypatch.setenv("ARCGYM_CACHE", str(tmp_path / "cache"))
    for name, bend in (("straight", 0.0), ("bent", 1.0)):
        (tmp_path / name).mkdir()
        write_tiny_colon(tmp_path / name, bend=bend)
    return [str(tmp_path / name / "colon.usda") for name in ("straight", "bent")]


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What is made instead of read from the cache."""
    made: list[str] = []
    read, build = patient_cache.read_patient, walls_module._build
    monkeypatch.setattr(
        patient_cache, "read_patient", lambda path, *rest: made.append(path.parent.name) or read(path, *rest)
    )
    monkeypatch.setattr(
        walls_module, "_build", lambda colon, k: made.append(f"wall of {colon.patients[k].name}") or build(colon, k)
    )
    return made


def test_the_cache_gives_what_was_made(paths: list[str], made: list[str]) -> None:
    first, second = (Colon(ColonCfg(usd_path=paths)) for _ in range(2))
    assert sorted(made) == ["bent", "straight"]
    made.clear()
    one, two = patient_walls(first), patient_walls(second)
    assert sorted(made) == ["wall of bent", "wall of straight"]
    for patient, again in zip(first.patients, second.patients, strict=True):
        assert (patient.path, patient.bounds, patient.material) == (again.path, again.bounds, again.material)
        np.testing.assert_array_equal(patient.visual.points, again.visual.points)
    for before, after in zip(one[1], two[1], strict=True):
        np.testing.assert_array_equal(before.plane, after.plane)
    for before, after in zip(one[0], two[0], strict=True):
        np.testing.assert_array_equal(before.elements.geometry.coupling, after.elements.geometry.coupling)
        assert before.moduli == after.moduli and before.colors[0].tolist() == after.colors[0].tolist()


def test_what_is_kept_outlives_the_link_by_which_it_was_read(paths: list[str], made: list[str], tmp_path: Path) -> None:
    links = tmp_path / "links"
    links.mkdir()
    for path in paths:
        (links / Path(path).parent.name).symlink_to(Path(path).parent)
    Colon(ColonCfg(usd_path=[str(links / "straight" / "colon.usda"), str(links / "bent" / "colon.usda")]))
    made.clear()
    for path in paths:
        (links / Path(path).parent.name).unlink()
    patients = Colon(ColonCfg(usd_path=paths)).patients
    assert not made
    assert [patient.albedo_texture.is_file() for patient in patients] == [True, True]


def test_one_patient_alone_is_not_kept(paths: list[str], made: list[str], tmp_path: Path) -> None:
    patient_walls(Colon(ColonCfg(usd_path=paths[1])))
    assert made == ["bent", "wall of bent"] and not (tmp_path / "cache").exists()


def test_other_tissue_makes_other_walls_of_the_same_patients(paths: list[str], made: list[str]) -> None:
    patient_walls(Colon(ColonCfg(usd_path=paths)))
    made.clear()
    patient_walls(Colon(ColonCfg(usd_path=paths, anchor_stiffness={"sigmoid": 1.0})))
    assert sorted(made) == ["wall of bent", "wall of straight"]


def test_a_changed_stage_is_read_anew(paths: list[str], made: list[str]) -> None:
    Colon(ColonCfg(usd_path=paths))
    before = stage_content(Path(paths[0]))
    write_tiny_colon(Path(paths[0]).parent, radius=0.021)
    made.clear()
    colon = Colon(ColonCfg(usd_path=paths))
    assert made == ["straight"] and stage_content(Path(paths[0])) != before
    assert np.linalg.norm(colon.patients[0].visual.points[0, :2]) == pytest.approx(0.021, rel=1e-3)


def test_a_stage_that_uses_files_from_elsewhere_is_not_kept(paths: list[str], tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    (other / "colon.usda").write_text(f"#usda 1.0\n(\n    subLayers = [@{paths[0]}@]\n)\n")
    assert stage_content(other / "colon.usda") == "" and stage_content(Path(paths[0])) != ""
