# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Specs from files, random patients, and the command that makes them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import kstest, truncnorm

from arcgym.anatomy import ColonSpec
from arcgym.anatomy.bends import acute_bends
from arcgym.anatomy.generator import output
from arcgym.anatomy.generator.acceptance import check_course
from arcgym.anatomy.generator.generate import AnatomyError, draw_surface
from arcgym.anatomy.generator.population import LENGTH_RANGE, draw_spec, segment_lengths
from arcgym.anatomy.generator.spec import FoldSpec, PolypSpec
from arcgym.anatomy.generator.spec_file import SpecError, read_spec
from arcgym.anatomy.generator.surface import Surface
from arcgym.anatomy.validation.checks import failed

ROOT = Path(__file__).resolve().parents[2]


def write(folder: Path, text: str) -> Path:
    (folder / "spec.yaml").write_text(text)
    return folder / "spec.yaml"


def test_empty_file_is_the_default(tmp_path: Path) -> None:
    assert read_spec(write(tmp_path, "")) == ColonSpec()


def test_every_kind_of_field(tmp_path: Path) -> None:
    text = """
    name: mine
    posture: prone
    clearance: 0.006
    polyp_radius: [0.003, 0.005]
    segments: {sigmoid: {length: 0.6, folds: {depth: 0.5}}, rectum: {folds: null}}
    polyp_list: [{segment: transverse, diameter: 0.008, paris: Ip}]
    mucosa: {stool: 0.1}
    """
    spec = read_spec(write(tmp_path, text))
    assert (spec.name, spec.posture, spec.clearance, spec.polyp_radius) == ("mine", "prone", 0.006, (0.003, 0.005))
    assert spec.segments["sigmoid"].length == 0.6 and spec.segments["rectum"].folds is None
    assert spec.segments["sigmoid"].folds == FoldSpec(0.021, 0.5, 0.0026, 0.9)
    assert spec.polyp_list == (PolypSpec("transverse", 0.008, "Ip"),)
    assert spec.mucosa.stool == 0.1 and spec.mucosa.width == 1024


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("wall_thickness: 0.05", "wall_thickness = 0.05 is out of range; expected 0.0005 to 0.006"),
        ("clearance: thick", "clearance is 'thick'; expected float"),
        ("segments: {sigmoid: {lenght: 1}}", "segments.sigmoid.lenght unknown; fields are length"),
        ("segments: {ileum: {length: 1}}", "ileum unknown; segments are rectum, sigmoid"),
        ("polyp_radius: [0.003]", "polyp_radius is .* expected a list of 2 values"),
        ("polyp_list: [{segment: rectum}]", r"polyp_list\[0\]: missing \['diameter'\]"),
        ("name: [", "cannot be read"),
        ("name: ''", "name = '' cannot name a folder"),
        ("seed: -1", "seed = -1 is out of range; expected 0 to"),
        ("acute_bends: 99", "acute_bends = 99 is out of range; expected 0 to 30"),
        ("grid: {sectors: 3}", "grid.sectors = 3 is out of range; expected 6 to 96"),
        ("grid: {visual: 7}", "grid.visual = 7 must be a multiple of grid.contact = 3"),
        ("sigmoid_state: tense", "sigmoid_state = 'tense' is unknown; expected one of relaxed, spastic, diverticular"),
        ("collapsed: [{segment: ileum}]", r"collapsed\[0\].segment = 'ileum' is unknown; expected one of rectum"),
        ("collapsed: [{segment: sigmoid, diameter: 0.01}]", r"collapsed\[0\].diameter = 0.01 is out of range"),
        ("inflation: 2", "inflation = 2 is out of range; expected 0.5 to 1.3"),
        ("mucosa: {bubbles: 0.7}", "mucosa.bubbles = 0.7 is out of range; expected 0 to 0.5"),
        ("mucosa: {paleness: 2}", "mucosa.paleness = 2 is out of range; expected 0 to 1"),
        ("material: {poissons_ratio: 0.5}", "material.poissons_ratio = 0.5 is out of range"),
        ("wide_neck: [0.009, 0.008]", "wide_neck = 0.009, 0.008 is in the wrong order"),
        ("transverse_shape: knot", "transverse_shape = 'knot' is unknown; expected one of plain, redundant"),
        ("segments: {sigmoid: {middle_diameter: 0.2}}", r"segments\['sigmoid'\].middle_diameter = 0.2 is out of range"),
        ("segments: {sigmoid: {wide_diverticula: 2}}", r"diverticula \(of which 2 wide\) = 0 is out of range"),
        ("segments: {sigmoid: {folds: {spacing: 0.01, width: 0.005}}}", "spacing = 0.01 leaves no room between folds"),
        ("segments: {cecum: {folds: {depth: 3}}}", r"segments\['cecum'\].folds.depth = 3 is out of range"),
        ("jitter: .nan", "jitter = nan is out of range"),
        ("just words", "'just words'; expected a mapping"),
    ],
)
def test_bad_specs_say_which_value_and_why(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(SpecError, match=message):
        read_spec(write(tmp_path, text))


def test_segments_add_up_and_follow_the_two_groups() -> None:
    """At the mean of Hanson's complete colonoscopies the sigmoid is 48.7 cm, of the incomplete ones 66.8 cm."""
    for total, sigmoid in ((1.670, 0.487), (2.108, 0.668)):
        lengths = segment_lengths(total)
        assert sum(lengths.values()) == pytest.approx(total)
        assert lengths["sigmoid"] == pytest.approx(sigmoid)


@pytest.fixture(scope="module")
def population() -> list[ColonSpec]:
    return [draw_spec(seed) for seed in range(400)]


def lengths_of(specs: list[ColonSpec]) -> np.ndarray:
    return np.array([sum(segment.length for segment in spec.segments.values()) for spec in specs])


def test_drawn_lengths_are_the_published_ones(population: list[ColonSpec]) -> None:
    """1.895 +- 0.263 m (n = 505); four standard errors of the mean; the cut takes 0.025 m off the deviation."""
    lengths = lengths_of(population)
    assert lengths.mean() == pytest.approx(1.895, abs=4 * 0.263 / 400**0.5)
    assert 0.22 < lengths.std() < 0.27
    assert lengths.min() > LENGTH_RANGE[0] - 0.01 and lengths.max() < LENGTH_RANGE[1] + 0.01


def test_length_distribution_is_normal_between_the_cuts(population: list[ColonSpec]) -> None:
    """Kolmogorov-Smirnov against the published normal distribution cut to the range."""
    low, high = ((bound - 1.895) / 0.263 for bound in LENGTH_RANGE)
    assert kstest(lengths_of(population), truncnorm(low, high, 1.895, 0.263).cdf).pvalue > 0.01


def test_womens_colons_are_longer(population: list[ColonSpec]) -> None:
    """Published difference 0.079 m; four standard errors of the difference of two halves are 0.1 m."""
    women = np.array(["woman" in spec.patient for spec in population])
    lengths = lengths_of(population)
    assert lengths[women].mean() - lengths[~women].mean() == pytest.approx(0.079, abs=0.1)
    assert women.mean() == pytest.approx(0.52, abs=0.1)


def test_drawn_bends_are_the_published_flexures(population: list[ColonSpec]) -> None:
    """10.9 +- 2.4; four standard errors of the mean are 0.48. Longer colons have more (9.6 against 11.9)."""
    bends, lengths = np.array([spec.acute_bends for spec in population]), lengths_of(population)
    assert bends.mean() == pytest.approx(10.9, abs=0.48)
    assert bends.std() == pytest.approx(2.4, abs=0.35)
    assert bends[lengths > 2.0].mean() - bends[lengths < 1.75].mean() > 1.0


def test_diverticula_are_as_common_as_published(population: list[ColonSpec]) -> None:
    counts = np.array([sum(segment.diverticula for segment in spec.segments.values()) for spec in population])
    assert (counts > 0).mean() == pytest.approx(0.42, abs=4 * (0.42 * 0.58 / 400) ** 0.5)
    assert all(spec.segments["rectum"].diverticula == 0 for spec in population)


def test_same_seed_same_patient() -> None:
    assert draw_spec(7) == draw_spec(7) and draw_spec(7) != draw_spec(8)


def test_a_draw_without_room_for_its_lesions_is_rejected() -> None:
    spec = draw_spec(173)
    assert spec.segments["cecum"].polyps == 1
    with pytest.raises(AnatomyError, match=r"\['cecum'\]: no room for another polyp"):
        draw_surface(spec, 0)
    assert any(lesion.kind in ("sessile", "pedunculated") for lesion in draw_surface(spec, 1)[1])


def first_valid_surface(spec: ColonSpec) -> Surface:
    """Return the surface of the first draw whose course the generator would accept."""
    for attempt in range(spec.max_attempts):
        try:
            surface, _ = draw_surface(spec, attempt)
        except AnatomyError:
            continue
        if not failed(check_course(spec, surface)):
            return surface
    raise AssertionError(f"no valid anatomy for {spec.name}")


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "scripts/tools/make_colon.py"), *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)


def test_bad_spec_leaves_nothing_behind(tmp_path: Path) -> None:
    result = run(write(tmp_path, "sigmoid_shape: knot"), tmp_path / "out")
    assert result.returncode == 2 and "'knot' is unknown; expected one of plain" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["spec.yaml"]


def test_a_colon_that_another_process_made_meanwhile_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "patient"
    out.mkdir()

    def remove_and_be_overtaken(folder: Path) -> None:
        (folder / "colon.usda").write_text("theirs")

    monkeypatch.setattr(output, "make_colon", lambda spec, folder: folder.mkdir())
    monkeypatch.setattr(output, "write_colon", lambda stage, path: path.write_text("ours"))
    monkeypatch.setattr(Path, "rmdir", remove_and_be_overtaken)
    with pytest.raises(OSError):
        output.make_to_folder(ColonSpec(), out)
    assert [path.name for path in out.iterdir()] == ["colon.usda"]
    assert (out / "colon.usda").read_text() == "theirs"


@pytest.mark.slow
def test_random_patients_have_their_bends_and_lengths() -> None:
    """Twelve random colons as generated: three standard errors of the published mean are 0.23 m and 2.1 bends."""
    bends, lengths, errors = [], [], []
    for seed in range(12):
        spec = draw_spec(seed)
        surface = first_valid_surface(spec)
        bends.append(len(acute_bends(surface.curve.points, surface.curve.s)))
        lengths.append(surface.curve.length)
        errors.append(abs(bends[-1] - (spec.acute_bends or 0)))
    assert np.mean(lengths) == pytest.approx(1.895, abs=0.23)
    assert np.mean(bends) == pytest.approx(10.9, abs=2.1)
    assert max(errors) <= 1


@pytest.mark.slow
def test_a_random_patient_from_the_command_line(tmp_path: Path) -> None:
    result = run("--seed", "2", tmp_path / "out")
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out" / "colon.usda").is_file()
