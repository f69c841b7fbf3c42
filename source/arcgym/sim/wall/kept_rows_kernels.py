# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Rows of the ring equations that are kept from one solution to the next, on a GPU.

Two warps solve a world's equations: one works its way from the first row to the middle one, the other from the last.
Where all rows from one on are what they were, the second has their factors from the last time.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class KeptRows:
    """What is known of each world's rows since the last solution."""

    first: wp.array[int]  # row from which on all are what they were, shape (W,)
    middle: wp.array[int]  # middle row of the last solution, the first whose factors are not kept; -1 for none, (W,)
    touched: wp.array2d[int]  # 1 where a contact was part of a row, else 0, shape (R, W)


@wp.func
def first_kept(kept: KeptRows, rows: int, w: int) -> int:
    """Return the first row of world ``w`` that is kept with its factors, of ``rows``; ``rows`` for none."""
    if kept.middle[w] < 0:
        return rows
    return wp.max(kept.first[w], kept.middle[w] + 1)
