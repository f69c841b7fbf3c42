# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Rest stiffness of a tetrahedron."""

from __future__ import annotations

import numpy as np
from small_strain import tet_stiffness

MU, LAM = 3.0, 5.0
TET = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.3, 0.1, 1.5]])


def energy(x: np.ndarray) -> float:
    """Stable neo-Hookean energy of TET deformed to x, Smith et al. 2018 with lambda + mu for lambda."""
    rest, now = (np.array([p[1] - p[0], p[2] - p[0], p[3] - p[0]]).T for p in (TET, x))
    f = now @ np.linalg.inv(rest)
    j = np.linalg.det(f)
    density = 0.5 * MU * (np.sum(f**2) - 3.0) - MU * (j - 1.0) + 0.5 * (LAM + MU) * (j - 1.0) ** 2
    return density * np.linalg.det(rest) / 6.0


def test_stiffness_is_the_second_difference_of_the_energy() -> None:
    shear, dilation = tet_stiffness(TET, np.array([[0, 1, 2, 3]]))
    k = (MU * shear + LAM * dilation)[0].reshape(12, 12)
    h, steps = 1e-4, np.eye(12).reshape(12, 4, 3)
    second = np.empty((12, 12))
    for a in range(12):
        for b in range(12):
            corners = [energy(TET + h * (s * steps[a] + t * steps[b])) for s, t in ((1, 1), (1, -1), (-1, 1), (-1, -1))]
            second[a, b] = (corners[0] - corners[1] - corners[2] + corners[3]) / (4 * h * h)
    np.testing.assert_allclose(k, second, atol=1e-5 * np.abs(k).max())
