# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Lengths of scope over which the wall's force is summed up: windows of one length, whatever the links are.

A force "on a link" shrinks with the link. Forces are therefore reported over fixed lengths of scope, counted from the
front of the tip backwards: overlapping windows along the whole scope, and the distal end, called the tip.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

WINDOW_LENGTH = 0.050
"""Length of scope in a window [m], a choice of this benchmark: four diameters of a colonoscope, two or more links.
Shorter windows change more with the length of the links, longer ones add up separate contacts."""
WINDOW_SPACING = 0.025
"""Distance from one window to the next [m]. Half a window, so that a contact up to 25 mm long lies wholly in one."""
TIP_LENGTH = 0.020
"""Length of the tip, from its front backwards [m], a choice of this benchmark: what a sensor at the end of a scope
could carry, and the whole of the capsule. A shorter tip would be part of one link, whose length would then show."""
ABUTTING = round(WINDOW_LENGTH / WINDOW_SPACING)
"""Every so many windows follow each other without a gap or an overlap."""


@dataclass(frozen=True)
class ForceWindows:
    """Shares of the links' forces in the tip (part 0) and in the windows (parts 1 to K), for one scope of L links.

    Attributes:
        start: Distance of the near end of each part from the front of the tip [m], shape (K + 1,).
        end: Distance of its far end [m], shape (K + 1,).
        share: Share of each link's force that counts in a part, in [0, 1], shape (K + 1, L).
    """

    start: np.ndarray
    end: np.ndarray
    share: np.ndarray

    @property
    def count(self) -> int:
        """Number of windows K."""
        return len(self.start) - 1

    @property
    def arc(self) -> np.ndarray:
        """Distance of the middle of each window from the front of the tip [m], shape (K,)."""
        return 0.5 * (self.start + self.end)[1:]


def force_windows(link_length: np.ndarray, tip_offset: float) -> ForceWindows:
    """Lay windows along a scope, front first; the last ends at or beyond the scope's base.

    The force on a link counts as spread evenly over it, and a part takes the share of the link that lies in it. A
    scope no longer than a window, such as a capsule, has one window.

    Args:
        link_length: Length of each link, base first [m], shape (L,).
        tip_offset: Distance from the center of the last link to the front of the tip [m]: its round end counts.
    """
    extent = np.array(link_length[::-1], float)
    extent[0] = 0.5 * extent[0] + tip_offset
    edges = np.concatenate([[0.0], np.cumsum(extent)])
    beyond = edges[-1] - WINDOW_LENGTH - 1.0e-9
    windows = 1 + max(0, int(np.ceil(beyond / WINDOW_SPACING)))
    start = np.concatenate([[0.0], WINDOW_SPACING * np.arange(windows)])
    end = start + np.concatenate([[TIP_LENGTH], np.full(windows, WINDOW_LENGTH)])
    end = np.minimum(end, edges[-1])
    overlap = np.minimum(end[:, None], edges[1:]) - np.maximum(start[:, None], edges[:-1])
    return ForceWindows(start, end, (np.maximum(overlap, 0.0) / extent)[:, ::-1])
