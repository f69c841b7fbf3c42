# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A seed gives the same colon on every processor, though sines and factorizations differ in their last digits."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arcgym.anatomy import read_colon
from arcgym.anatomy.generator.acute_bends import BendTargets
from arcgym.anatomy.generator.centerline import SAMPLE_SPACING, base_radius
from arcgym.anatomy.generator.kept_courses import KEPT_COURSES, kept_course
from arcgym.anatomy.generator.patients import PATIENTS
from arcgym.anatomy.generator.relaxation import MOST_BENDS, relax
from arcgym.anatomy.generator.rounding import STEP
from arcgym.anatomy.generator.spec import ColonSpec
from arcgym.anatomy.polyline import arc_lengths

OLD_PROCESSOR = {"NPY_DISABLE_CPU_FEATURES": "AVX512_ICL X86_V4 X86_V3", "OPENBLAS_CORETYPE": "Sandybridge"}
"""Makes numpy and OpenBLAS compute as on a processor of 2011."""


def test_a_course_does_not_hang_on_the_last_digit() -> None:
    """A loop that comes back on itself, so that its limbs push each other and amplify what differs."""
    spec, rng = replace(ColonSpec(), acute_bends=3), np.random.default_rng(0)
    angle = np.linspace(0.0, 1.7 * np.pi, 120)
    route = 0.09 * np.stack([np.sin(angle), 1.0 - np.cos(angle), 0.1 * angle], 1) + rng.normal(0.0, 0.002, (120, 3))
    edge, arc = np.full(119, SAMPLE_SPACING), arc_lengths(route)
    drawn, hold = rng.uniform(size=(MOST_BENDS, 2)), np.full(120, 0.003)
    other = 1.0 + 4e-16 * rng.integers(-1, 2, 120)
    first = relax(route, edge, base_radius(spec, arc), hold, spec, drawn)
    second = relax(route * other[:, None], edge * other[1:], base_radius(spec, arc) * other, hold, spec, drawn)
    assert np.array_equal(first, second)
    assert np.abs(first - route).max() > 100 * STEP


def test_a_bend_in_its_shape_is_not_pulled_however_it_lies() -> None:
    shape = np.array([[[-1.0, -0.5], [0.0, 1.0], [1.0, -0.5]]])
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    points = np.concatenate([[[9.0, 9.0, 9.0]], shape[0] @ turn[:2] + [0.3, 0.2, 0.1]])
    pull = BendTargets(np.array([[1, 2, 3]]), shape).pull
    assert np.allclose(pull(points.T), 0.0, atol=1e-14)
    points[2] += [0.1, 0.0, 0.0]
    assert np.abs(pull(points.T)[:, 1:]).max() > 0.01 and not pull(points.T)[:, 0].any()


def test_a_bend_turns_as_the_polar_decomposition_says() -> None:
    """Shape matching by the singular value decomposition, of which the arithmetic is a closed form in a plane."""
    rng = np.random.default_rng(2)
    shape, points = rng.normal(size=(9, 2)), rng.normal(size=(9, 3))
    shape -= shape.mean(0)
    here = points - points.mean(0)
    left, _, right = np.linalg.svd(shape.T @ here, full_matrices=False)
    expected = 0.4 * (shape @ left @ right - here)
    assert np.allclose(BendTargets(np.arange(9)[None], shape[None]).pull(points.T).T, expected)


def test_kept_courses_are_those_of_the_five_patients() -> None:
    assert sorted(PATIENTS) == sorted(KEPT_COURSES) == sorted(make().course or "" for make in PATIENTS.values())
    for name, make in PATIENTS.items():
        points, ends = kept_course(name, make().posture)
        assert len(ends) == 8 and arc_lengths(points)[-1] == pytest.approx(ends[-1])


def test_a_course_that_is_not_kept_is_named() -> None:
    with pytest.raises(ValueError, match="ColonSpec.course = 'colon_9' is unknown; expected one of colon_1, colon_2"):
        replace(ColonSpec(), course="colon_9")
    with pytest.raises(ValueError, match="course = 'colon_1' is not kept for posture 'prone'; kept are colon_1_supine"):
        kept_course("colon_1", "prone")


@pytest.mark.slow
def test_another_processor_makes_the_same_stage(tmp_path: Path) -> None:
    command = "from arcgym.anatomy.generator.stored_patients import main; import sys; main(*sys.argv[1:])"
    stages = []
    for name, environment in {"this": {}, "old": OLD_PROCESSOR}.items():
        run = [sys.executable, "-c", command, str(tmp_path / name), "10001"]
        subprocess.run(run, env={**os.environ, **environment}, check=True)
        stages.append(read_colon(tmp_path / name / "patient_10001" / "colon.usda"))
    for part in ("wall", "contact", "visual", "visual_proxy", "centerline"):
        here, there = (getattr(stage, part).points for stage in stages)
        assert np.allclose(here, there, rtol=0.0, atol=1e-6), part
