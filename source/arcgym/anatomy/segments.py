# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The eight anatomical segments of the large intestine, in the order in which a colonoscope meets them."""

from __future__ import annotations

SEGMENTS = ("rectum", "sigmoid", "descending", "splenic", "transverse", "hepatic", "ascending", "cecum")
"""Segment names; the position of a name is the integer in every ``segment`` array."""

RETROPERITONEAL = ("rectum", "descending", "splenic", "hepatic", "ascending")
"""Segments held to the posterior abdominal wall (rectum, descending and ascending colon) or by ligaments (flexures).

The sigmoid, the transverse colon and the cecum hang on a mesentery and move freely (Standring, Gray's Anatomy).
"""

ANCHOR_FREE = 0
"""Anchor code of a vertex that is held by its neighbors only."""

ANCHOR_ELASTIC = 1
"""Anchor code of a vertex that an elastic attachment pulls to its rest position."""

ANCHOR_FIXED = 2
"""Anchor code of a vertex that never moves."""


def segment_index(name: str) -> int:
    """Return the integer code of a segment.

    Args:
        name: One of :data:`SEGMENTS`.

    Raises:
        ValueError: The name is unknown.
    """
    if name not in SEGMENTS:
        raise ValueError(f"Unknown colon segment '{name}'; expected one of {', '.join(SEGMENTS)}.")
    return SEGMENTS.index(name)
