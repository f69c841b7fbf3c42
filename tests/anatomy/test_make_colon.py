# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Specs from files, random patients, and the command that makes them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from arcgym.anatomy import ColonSpec
from arcgym.anatomy.population import LENGTH_RANGE, draw_spec, segment_lengths
from arcgym.anatomy.spec import FoldSpec, PolypSpec
from arcgym.anatomy.spec_file import SpecError, read_spec

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


def test_drawn_population_has_the_published_statistics() -> None:
    """N(1.895, 0.263) m cut to 1.40-2.10 m has mean 1.816 and deviation 0.173 m; four standard errors are allowed."""
    specs = [draw_spec(seed) for seed in range(600)]
    lengths = np.array([sum(segment.length for segment in spec.segments.values()) for spec in specs])
    diverticula = np.array([sum(segment.diverticula for segment in spec.segments.values()) for spec in specs])
    assert lengths.mean() == pytest.approx(1.816, abs=4 * 0.173 / 600**0.5)
    assert lengths.std() == pytest.approx(0.173, abs=0.02)
    assert lengths.min() > LENGTH_RANGE[0] - 0.01 and lengths.max() < LENGTH_RANGE[1] + 0.01
    assert (diverticula > 0).mean() == pytest.approx(0.42, abs=0.08)
    assert all(spec.segments["rectum"].diverticula == 0 for spec in specs)


def test_same_seed_same_patient() -> None:
    assert draw_spec(7) == draw_spec(7) and draw_spec(7) != draw_spec(8)


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "scripts/tools/make_colon.py"), *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)


def test_bad_spec_leaves_nothing_behind(tmp_path: Path) -> None:
    result = run(write(tmp_path, "sigmoid_shape: knot"), tmp_path / "out")
    assert result.returncode == 1 and "'knot' is unknown; expected one of plain" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["spec.yaml"]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_random_patients_can_be_made(tmp_path: Path, seed: int) -> None:
    result = run("--seed", str(seed), tmp_path / "out")
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out" / "colon.usda").is_file()
