# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Which rows of the texture a stretch of colon shows, and that its vessels differ."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.anatomy.mucosa.vessel_styles import STYLES, texture_rows
from arcgym.anatomy.mucosa.vessels import draw_vessels
from arcgym.anatomy.segments import SEGMENTS


def test_styles_cover_segments_and_texture_in_order() -> None:
    assert tuple(name for style in STYLES for name in style.segments) == SEGMENTS
    assert [style.band[0] for style in STYLES] == [0.0, *(style.band[1] for style in STYLES[:-1])]
    assert STYLES[-1].band[1] == 1.0


def test_rows_stay_in_their_band_and_do_not_jump() -> None:
    ends = 0.2 * np.arange(1, len(SEGMENTS) + 1)
    bounds = {name: (end - 0.2, end) for name, end in zip(SEGMENTS, ends, strict=True)}
    s = np.linspace(0.0, ends[-1], 4000)
    v = texture_rows(s, bounds, 0.24)
    for style in STYLES:
        inside = (s > bounds[style.segments[0]][0]) & (s < bounds[style.segments[-1]][1])
        assert v[inside].min() >= style.band[0] and v[inside].max() <= style.band[1]
    assert np.abs(np.diff(v)).max() < 2 * np.diff(s).max() / 0.24


def test_rectum_is_dense_and_the_right_colon_runs_round() -> None:
    """Share of vessel pixels by band, and how much faster the picture changes along the colon than round it."""
    image = draw_vessels(np.random.default_rng(0), 1024, 512)
    rows = [slice(round(1024 * style.band[0]), round(1024 * style.band[1])) for style in STYLES]
    covered = [(image[row] > 0.2).mean() for row in rows]
    along, around = (np.abs(np.diff(image, axis=axis)) for axis in (0, 1))
    ratio = [along[row].mean() / around[row].mean() for row in rows]
    assert covered[0] > 1.5 * covered[1] and covered[0] > 1.1 * covered[3]
    assert ratio[3] > 1.3 * ratio[0]
    assert ratio[0] == pytest.approx(1.0, abs=0.3)
