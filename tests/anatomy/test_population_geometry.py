# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Random patients beside real colons: how tight they bend, how much they turn, how wide they are; and the splits."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.anatomy.course_measures import CourseMeasures, measure_course
from arcgym.anatomy.generator.acceptance import check_course
from arcgym.anatomy.generator.generate import GENERATOR_VERSION, draw_surface
from arcgym.anatomy.generator.population import draw_spec
from arcgym.anatomy.generator.splits import read_splits, split_seeds
from arcgym.anatomy.grid_shape import GridShape
from arcgym.anatomy.validation.checks import failed

REAL = {
    "bend_radius_p5": (0.015, 0.018),
    "bend_radius_least": (0.014, 0.015),
    "tight_share": (0.19, 0.33),
    "turning_p95": (np.radians(113), np.radians(154)),
    "turning_most": (np.radians(140), np.radians(171)),
    "total_turning": (np.radians(1270), np.radians(1640)),
    "bend_over_lumen_p5": (0.85, 1.0),
    "diameter_p5": (0.021, 0.031),
    "diameter_p50": (0.028, 0.044),
    "diameter_p95": (0.055, 0.063),
}
"""Least and largest value of five colons from CT, as the importer of 940eca8 measured them [m, rad, rad/m]; it opened
their courses where rings across them would have crossed."""

ALLOWED = 0.25
"""By how much the median of random patients may leave the range of five real ones, as a share of its bounds."""


def measures(seeds: range) -> dict[str, np.ndarray]:
    """Measure the first valid course of each seed."""
    found: list[CourseMeasures] = []
    for seed in seeds:
        spec = draw_spec(seed)
        draws = (draw_surface(spec, attempt)[0] for attempt in range(spec.max_attempts))
        surface = next(surface for surface in draws if not failed(check_course(spec, surface)))
        found.append(measure_course(surface.curve.points, surface.mean_radius))
    values = {name: np.array([getattr(m, name) for m in found]) for name in REAL if hasattr(found[0], name)}
    return values | {f"diameter_p{p}": np.array([m.diameter[k] for m in found]) for k, p in enumerate((5, 50, 95))}


def compare(seeds: range) -> None:
    """Each median lies in the real range or near it, and the real ranges lie within what the population covers."""
    for name, values in measures(seeds).items():
        low, high = REAL[name]
        assert low * (1 - ALLOWED) < np.median(values) < high * (1 + ALLOWED), name
        middle = 0.5 * (low + high)
        assert values.min() < middle * (1 + ALLOWED) and values.max() > middle * (1 - ALLOWED), name


def test_measures_of_a_bend_of_known_radius() -> None:
    """A quarter turn of 30 mm between straight legs: the smoothing of 5 mm opens it by about a percent."""
    angle = np.linspace(0, np.pi / 2, 50)
    bend = 0.03 * np.stack([np.sin(angle), 1 - np.cos(angle), 0 * angle], 1)
    before = np.linspace([-0.1, 0, 0], [-0.001, 0, 0], 100)
    after = bend[-1] + np.linspace([0, 0.001, 0], [0, 0.1, 0], 100)
    line = np.concatenate([before, bend, after])
    found = measure_course(line, np.full(len(line), 0.02))
    assert found.length == pytest.approx(0.2 + 0.03 * np.pi / 2, rel=0.01)
    assert found.bend_radius_least == pytest.approx(0.030, rel=0.05)
    assert found.turning_most == pytest.approx(np.pi / 2, abs=0.05)
    assert found.total_turning * (found.length - 0.02) == pytest.approx(np.pi / 2, rel=0.02)
    assert found.diameter == pytest.approx((0.04, 0.04, 0.04))
    assert found.bend_over_lumen_p5 == pytest.approx(1.5, rel=0.05)
    assert found.tight_share == 0.0 and found.acute_bends == 0


def test_random_patients_bend_as_real_colons_do() -> None:
    compare(range(4))


@pytest.mark.slow
def test_more_random_patients_bend_as_real_colons_do() -> None:
    compare(range(10000, 10040))


def test_splits_do_not_share_a_seed() -> None:
    splits = read_splits()
    sizes = {name: len(seeds) for name, seeds in splits.seeds.items()}
    assert sizes == {"train": 10000, "validation": 100, "test": 200}
    assert len(set().union(*splits.seeds.values())) == sum(sizes.values())
    assert splits.generator == GENERATOR_VERSION
    assert splits.grid == (GridShape().rings, GridShape().sectors)  # another grid is another version of the splits


def test_unknown_split_lists_the_known() -> None:
    with pytest.raises(ValueError, match="Unknown split 'tests' of the population.*test"):
        split_seeds("tests")
