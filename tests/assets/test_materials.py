# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Values of the tissue presets."""

from __future__ import annotations

import pytest

from arcgym.assets.materials import ANCHOR_SCALES, ANCHOR_STIFFNESS, TISSUE_PRESETS, tissue_preset


def test_paper_keeps_the_stage_thickness_and_has_no_slack() -> None:
    paper = tissue_preset("paper")
    assert (paper.youngs_modulus, paper.poissons_ratio, paper.thickness) == (5.0e6, 0.49, None)
    assert paper.anchor_stiffness == ANCHOR_STIFFNESS and paper.anchor_slack == {}


def test_in_situ_is_thinner_softer_and_hangs_in_a_mesentery() -> None:
    tissue = tissue_preset("in_situ")
    assert (tissue.youngs_modulus, tissue.thickness) == (0.5e6, 0.0015)
    assert tissue.anchor_slack == {"sigmoid": 0.063, "transverse": 0.074}
    # 0.5 MPa of 1 mm over 63 mm.
    assert tissue.anchor_stiffness["sigmoid"] == pytest.approx(0.5e6 * 1e-3 / 0.063)
    assert tissue.anchor_stiffness["descending"] == ANCHOR_STIFFNESS["descending"]


def test_sensitivity_presets_are_three_moduli_by_two_ratios() -> None:
    settings = {
        (p.youngs_modulus, p.poissons_ratio)
        for name, p in TISSUE_PRESETS.items()
        if name not in ("paper", "in_situ", "clinical")
    }
    assert settings == {(modulus, ratio) for modulus in (0.5e6, 5.0e6, 10.0e6) for ratio in (0.45, 0.49)}


def test_anchors_are_the_papers_shares_of_anchored_vertices() -> None:
    assert ANCHOR_SCALES == {"sparse": 0.5, "default": 1.0, "dense": 1.75}
