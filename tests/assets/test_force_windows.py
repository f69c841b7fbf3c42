# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Shares of the links' forces in the tip and in windows of 50 mm every 25 mm, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from arcgym.assets.force_windows import ABUTTING, force_windows

HALF = 0.0125
"""Distance from the center of a link of 25 mm to its front [m]: no round end stands out."""


def test_a_link_counts_by_its_part_in_a_window() -> None:
    # Links of 25 mm from the front: 0-25, 25-50, 50-75, 75-100 mm. Windows: 0-50, 25-75, 50-100 mm.
    windows = force_windows(np.full(4, 0.025), HALF)
    np.testing.assert_allclose(windows.arc, [0.025, 0.050, 0.075])
    np.testing.assert_allclose(windows.share[1:], [[0, 0, 1, 1], [0, 1, 1, 0], [1, 1, 0, 0]], atol=1e-12)


def test_a_link_that_straddles_two_windows_is_divided() -> None:
    # From the front: a link of 40 mm, one of 25 mm from 40 to 65 mm, one of 35 mm. 10 of the 25 mm lie in the first
    # window (0-50), all of them in the second (25-75), 15 mm in the third (50-100): 0.4 N, 1 N and 0.6 N of 1 N.
    windows = force_windows(np.array([0.035, 0.025, 0.040]), 0.020)
    np.testing.assert_allclose(windows.share[1:] @ [0.0, 1.0, 0.0], [0.4, 1.0, 0.6])


def test_the_tip_is_the_front_20_mm_with_the_round_end() -> None:
    # A last link of 10 mm whose round end stands out by 6.6 mm fills 16.6 mm; the next gives 3.4 of its 10 mm.
    windows = force_windows(np.full(10, 0.010), 0.0116)
    np.testing.assert_allclose(windows.share[0, -3:], [0.0, 0.34, 1.0])


def test_a_capsule_is_one_window_and_its_own_tip() -> None:
    windows = force_windows(np.array([0.020]), 0.010)
    assert windows.count == 1
    np.testing.assert_allclose(windows.share, [[1.0], [1.0]])
    np.testing.assert_allclose(windows.arc, [0.010])


@pytest.mark.parametrize("link", [0.025, 0.0125, 0.00625, 0.010])
def test_windows_do_not_depend_on_the_links(link: float) -> None:
    # A load of 100 N/m on the 50 mm from 25 to 75 mm behind the front, on links of every length.
    links = round(0.2 / link)
    ends = link * np.arange(links, 0, -1)  # base first: distance of each link's far end from the front
    load = 100.0 * np.clip(np.minimum(ends, 0.075) - np.maximum(ends - link, 0.025), 0.0, None)
    windows = force_windows(np.full(links, link), 0.5 * link)
    assert windows.count == 7
    exact = [2.5, 5.0, 2.5, 0.0, 0.0, 0.0, 0.0]
    # Links of 10 mm do not end at 25 and 75 mm: the two at the ends spread 0.5 N each over 10 mm instead of 5 mm.
    np.testing.assert_allclose(windows.share[1:] @ load, exact, atol=0.51 if link == 0.010 else 1e-9)


def test_abutting_windows_add_up_to_the_whole_scope() -> None:
    # 150 mm: windows 0, 2 and 4 follow each other.
    windows = force_windows(np.full(6, 0.025), HALF)
    np.testing.assert_allclose(windows.share[1::ABUTTING].sum(axis=0), 1.0)


def test_every_place_lies_in_a_window_however_long_the_base_link() -> None:
    # 0.2 m of base link, 1.2 m of shaft, 0.1 m of bending section with a round end of 6.6 mm.
    windows = force_windows(np.array([0.2] + [0.025] * 48 + [0.010] * 10), 0.0116)
    assert windows.count == 60
    assert (windows.share[1:].sum(axis=0) > 0.99).all()
    assert windows.end[-1] == pytest.approx(1.5066)
