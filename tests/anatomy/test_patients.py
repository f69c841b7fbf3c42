# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The five patients are what their descriptions say."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from welded import welded

from arcgym.anatomy import SEGMENTS, ColonStage, read_colon
from arcgym.anatomy.bends import acute_bends
from arcgym.anatomy.generator.patients import COLON_5_POLYPS, PATIENTS
from arcgym.anatomy.generator.spec import ColonSpec, PolypSpec
from arcgym.anatomy.segments import RETROPERITONEAL
from arcgym.anatomy.validation.checks import failed
from arcgym.anatomy.validation.stage_checks import inspect_stage
from arcgym.anatomy.validation.wall_checks import ring_distance

ASSETS = Path(__file__).resolve().parents[2] / "assets" / "usd"


@pytest.fixture(scope="module")
def stages() -> dict[str, ColonStage]:
    return {name: read_colon(ASSETS / name / "colon.usda") for name in PATIENTS}


def patches(stage: ColonStage, mark: np.ndarray) -> dict[str, int]:
    """Count the connected patches of marked fine vertices by segment."""
    faces = welded(stage.visual)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    edges = edges[mark[edges].all(1)]
    graph = coo_array((np.ones(len(edges)), edges.T), shape=(len(mark), len(mark)))
    used = np.unique(edges)
    labels = connected_components(graph, directed=False)[1][used]
    segment = stage.wall.segment[stage.visual.skin_indices[used, 0]]
    firsts = np.unique(labels, return_index=True)[1]
    return {SEGMENTS[k]: int((segment[firsts] == k).sum()) for k in np.unique(segment[firsts])}


@pytest.mark.parametrize("name", list(PATIENTS))
def test_every_patient_passes_every_check(stages: dict[str, ColonStage], name: str) -> None:
    assert failed(inspect_stage(stages[name])) == []


@pytest.mark.parametrize("name", list(PATIENTS))
def test_folder_is_small(name: str) -> None:
    assert sum(file.stat().st_size for file in (ASSETS / name).glob("*.*")) < 8.2e6


def test_lengths_are_the_clinical_ones(stages: dict[str, ColonStage]) -> None:
    """Redundant means a sigmoid or transverse colon of about 60 cm, half of each flexure counted."""
    length = {n: {k: b - a for k, (a, b) in stage.segment_bounds().items()} for n, stage in stages.items()}
    for name in ("colon_2", "colon_3", "colon_4"):
        parts = length[name]
        assert parts["transverse"] + 0.5 * (parts["splenic"] + parts["hepatic"]) > 0.60, name
    assert length["colon_4"]["sigmoid"] > 0.68 and length["colon_5"]["sigmoid"] > 0.60
    assert stages["colon_4"].length > max(stages[n].length for n in PATIENTS if n != "colon_4") + 0.1


def test_prone_and_supine_are_the_same_wall(stages: dict[str, ColonStage]) -> None:
    """Same landmarks and lumen; the held segments move less than 15 mm, the mobile ones more."""
    prone, supine = stages["colon_2"], stages["colon_3"]
    assert prone.landmarks == pytest.approx(supine.landmarks, abs=1e-4)
    assert prone.wall.num_rings == supine.wall.num_rings
    assert np.median(np.abs(prone.centerline.radius / supine.centerline.radius - 1.0)) < 0.05
    assert all(prone.metadata.get(k) == supine.metadata.get(k) for k in ("seed", "attempt"))
    moved = np.linalg.norm(prone.centerline.points - supine.centerline.points, axis=1)
    by_segment = {name: moved[supine.centerline.segment == k].max() for k, name in enumerate(SEGMENTS)}
    assert max(by_segment[name] for name in RETROPERITONEAL) < 0.015
    assert by_segment["sigmoid"] > 0.04 and by_segment["transverse"] > 0.04


def test_prone_presses_the_mobile_segments_back(stages: dict[str, ColonStage]) -> None:
    for k in (SEGMENTS.index("sigmoid"), SEGMENTS.index("transverse")):
        y = {n: stages[n].centerline.points[stages[n].centerline.segment == k, 1].max() for n in ("colon_2", "colon_3")}
        assert y["colon_2"] < y["colon_3"] - 0.01


def test_sixteen_polyps_of_the_listed_sizes(stages: dict[str, ColonStage]) -> None:
    sizes = np.array([polyp.diameter for polyp in COLON_5_POLYPS])
    assert [(sizes <= 0.005).sum(), ((sizes > 0.005) & (sizes < 0.010)).sum(), (sizes >= 0.010).sum()] == [8, 5, 3]
    assert sum(patches(stages["colon_5"], stages["colon_5"].visual.tint > 0.5).values()) == 16


def test_diverticula_left_and_right_in_colon_5(stages: dict[str, ColonStage]) -> None:
    counts = patches(stages["colon_5"], stages["colon_5"].visual.tint < -0.5)
    assert counts == {"descending": 15, "ascending": 10}


@pytest.mark.parametrize("name", ["colon_2", "colon_3", "colon_4"])
def test_no_polyps_or_diverticula(stages: dict[str, ColonStage], name: str) -> None:
    assert np.abs(stages[name].visual.tint).max() < 0.5


@pytest.mark.parametrize("name", list(PATIENTS))
def test_cecum_has_valve_and_appendix(stages: dict[str, ColonStage], name: str) -> None:
    marks = stages[name].landmarks
    order = ["cecum_entry", "ileocecal_valve", "appendix_orifice", "cecum_pole"]
    assert [mark for mark in marks if mark in order] == order


@pytest.mark.parametrize(("name", "wanted"), list(zip(PATIENTS, (10, 11, 11, 14, 11), strict=True)))
def test_acute_bends(stages: dict[str, ColonStage], name: str, wanted: int) -> None:
    line = stages[name].centerline
    assert len(acute_bends(line.points.astype(float), line.arc.astype(float))) == pytest.approx(wanted, abs=1)


@pytest.mark.parametrize("name", list(PATIENTS))
def test_rings_keep_apart_in_bends(stages: dict[str, ColonStage], name: str) -> None:
    assert ring_distance(stages[name].wall) > 0.003


def test_unknown_paris_class_lists_the_known() -> None:
    with pytest.raises(ValueError, match=r"polyp_list\[0\].paris = 'IV' is unknown; expected one of Ip, Is, IIa"):
        ColonSpec(polyp_list=(PolypSpec("rectum", 0.005, "IV"),))


def test_unknown_posture_lists_the_known() -> None:
    with pytest.raises(ValueError, match="posture = 'upright' is unknown; expected one of supine, prone"):
        replace(ColonSpec(), posture="upright")
