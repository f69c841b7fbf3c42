# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contact of the two limbs of a bend that is drawn to a hairpin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from arcgym.sim.contact.bend_contact_kernels import Bends
from arcgym.sim.contact.self_contact import SelfContact


def limbs_that_touch(contact: SelfContact, points: Sequence[np.ndarray]) -> Bends:
    """Return the rings of bends whose limbs push on each other, see ``bend_contact_kernels``.

    Limbs that overlap at rest may go on doing so.

    Args:
        contact: Contact of the wall with itself, which measures the rings' spheres in every step from here on.
        points: Rest positions of each patient's wall [m], shape (V, 3).
    """
    bends = Bends()
    bends.rings = contact.rings_of_any_pair(points)
    bends.spheres, bends.loop_gap = contact.spheres, contact.rings.min_gap
    return bends
