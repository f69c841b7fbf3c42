# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Shipped scopes in other lengths."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arcgym.assets import CAPSULE_CFG, MAGNETIC_CFG, PROXIMAL_CFG
from arcgym.assets.endoscope import Endoscope


@pytest.mark.parametrize("cfg", [MAGNETIC_CFG, PROXIMAL_CFG], ids=["magnetic", "proximal"])
def test_a_longer_scope_has_more_links_of_the_same_kind(cfg, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ARCGYM_CACHE", str(tmp_path))
    usual, longer = Endoscope(cfg.copy()), Endoscope(replace(cfg.copy(), length=2.03))
    assert longer.stage.total_length == pytest.approx(2.03)
    assert longer.num_bodies - usual.num_bodies == 28  # 0.35 m in links of 12.5 mm
    np.testing.assert_allclose(longer.stage.link_length[1:][-130:][:5], 0.0125)
    np.testing.assert_allclose(longer.stage.hinge_stiffness[-100:], usual.stage.hinge_stiffness[-100:], rtol=1e-6)
    assert longer.path.parent == tmp_path / "endoscopes"


def test_a_capsule_has_no_shaft_to_lengthen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ARCGYM_CACHE", str(tmp_path))
    with pytest.raises(ValueError, match=r"length is 2 m, but capsule.usda is no shipped scope with a shaft"):
        Endoscope(replace(CAPSULE_CFG.copy(), length=2.0))
