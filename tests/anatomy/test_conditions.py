# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Less gas, collapsed stretches, states of the sigmoid, and what lies on the mucosa."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from arcgym.anatomy.curve import Curve
from arcgym.anatomy.generator.conditions import effective_segment, narrowed
from arcgym.anatomy.generator.spec import CollapseSpec, ColonSpec
from arcgym.anatomy.mucosa.spec import MucosaSpec
from arcgym.anatomy.mucosa.texture import make_textures


def test_less_gas_makes_every_segment_narrower_down_to_the_least_lumen() -> None:
    spec = replace(ColonSpec(), inflation=0.5, min_lumen_radius=0.009)
    assert effective_segment(spec, "cecum").middle_diameter == pytest.approx(0.033)
    assert effective_segment(spec, "sigmoid").start_diameter == 0.018


@pytest.mark.parametrize(("state", "stagger", "diverticula"), [("spastic", 0.0, 0), ("diverticular", 0.5, 12)])
def test_states_of_the_sigmoid(state: str, stagger: float, diverticula: int) -> None:
    """Narrower, with closer folds; rings one behind the other in a spasm, diverticula where the muscle is thick."""
    plain, spec = ColonSpec(), replace(ColonSpec(), sigmoid_state=state)
    before, after = (effective_segment(each, "sigmoid") for each in (plain, spec))
    assert before.folds is not None and after.folds is not None
    assert after.middle_diameter < 0.85 * before.middle_diameter and after.length == before.length
    assert after.folds.spacing < before.folds.spacing
    assert (after.folds.stagger, after.diverticula) == (stagger, diverticula)
    assert effective_segment(spec, "descending") == effective_segment(plain, "descending")


def test_collapsed_stretch() -> None:
    """In a straight colon of 1.6 m with segments of 0.2 m: 18 mm wide about the middle of the sigmoid, at 0.3 m."""
    curve = Curve(np.linspace([0, 0, 0], [0, 0, 1.6], 100), 0.2 * np.arange(1, 9))
    spec = replace(ColonSpec(), collapsed=(CollapseSpec("sigmoid", 0.5, 0.08, 0.018),))
    radius = narrowed(spec, curve, np.full(len(curve.s), 0.02))
    inside, outside = np.abs(curve.s - 0.3) < 0.019, np.abs(curve.s - 0.3) > 0.061
    assert radius[inside] == pytest.approx(0.009) and radius[outside] == pytest.approx(0.02)
    assert np.interp(0.34, curve.s, radius) == pytest.approx(0.0145, abs=3e-4)


def test_a_collapsed_stretch_does_not_widen_a_narrow_colon() -> None:
    curve = Curve(np.linspace([0, 0, 0], [0, 0, 1.6], 100), 0.2 * np.arange(1, 9))
    spec = replace(ColonSpec(), collapsed=(CollapseSpec("sigmoid", diameter=0.05),))
    assert narrowed(spec, curve, np.full(len(curve.s), 0.02)) == pytest.approx(0.02)


@pytest.mark.parametrize("what", ["fluid", "bubbles", "stool"])
def test_what_lies_on_the_mucosa_covers_its_share(what: str) -> None:
    plain, _ = make_textures(0, width=128, height=256)
    covered, detail = make_textures(0, width=128, height=256, look=replace(MucosaSpec(), **{what: 0.3}))
    changed = (np.abs(covered.astype(int) - plain).max(2) > 3).mean()
    assert 0.2 < changed <= 0.31
    assert covered.dtype == np.uint8 and detail.shape == (256, 128, 4)
