# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Strain of the lumen faces and pull of the anchors, ring by ring.

W worlds, V wall vertices, F lumen faces, R rings. Arrays over worlds are world-fastest: (V, W), (R, W).
"""

import warp as wp

from arcgym.sim.wall.anchor_kernels import Anchors, anchor_pull
from arcgym.utils import warp_setup  # noqa: F401


@wp.struct
class RestRings:
    """Lumen faces and anchor springs of each of P patients at rest, sorted by ring."""

    face: wp.array[wp.vec3i]  # vertices of each lumen face, shape (F,)
    inverse: wp.array2d[wp.vec3]  # (1 / a, b / a, 1 / h) of each face at rest, see face_strain, shape (F, P)
    face_start: wp.array[int]  # first face of each ring, shape (R + 1,)
    anchored: wp.array[int]  # vertices held by a spring in some patient, shape (A,)
    anchors: Anchors
    anchor_start: wp.array[int]  # first anchored vertex of each ring, shape (R + 1,)


@wp.func
def face_strain(a: wp.vec3, b: wp.vec3, c: wp.vec3, inverse: wp.vec3) -> float:
    """Return the largest principal stretch of a triangle, minus one.

    At rest its first edge is (a, 0) and its second (b, h) in the plane, so that the columns of the deformation
    gradient are e1 / a and (e2 - e1 b / a) / h. The stretch is the root of the largest eigenvalue of F^T F.
    """
    f1 = (b - a) * inverse[0]
    f2 = (c - a - (b - a) * inverse[1]) * inverse[2]
    c11 = wp.dot(f1, f1)
    c22 = wp.dot(f2, f2)
    c12 = wp.dot(f1, f2)
    half = 0.5 * (c11 - c22)
    return wp.sqrt(0.5 * (c11 + c22) + wp.sqrt(half * half + c12 * c12)) - 1.0


@wp.kernel
def measure_rings(
    first: int,
    x: wp.array2d[wp.vec3],
    rings: RestRings,
    anchor_scale: wp.array[float],
    strain: wp.array2d[float],
    strain_peak: wp.array2d[float],
    tension: wp.array2d[float],
    tension_peak: wp.array2d[float],
):
    """Add this step's largest strain and net anchor pull of each ring to the sums and peaks. Launch (R, W), or some of
    the rows.

    Args:
        first: First row of this launch.
        x: Wall positions [m], shape (V, W).
        rings: Lumen faces and springs of all patients.
        anchor_scale: Factor on the springs of each world, shape (W,).
        strain: Sum of strains, shape (R, W); added to.
        strain_peak: Largest strain, shape (R, W); raised.
        tension: Sum of tensions [N], shape (R, W); added to.
        tension_peak: Largest tension [N], shape (R, W); raised.
    """
    r, w = wp.tid()
    r += first
    p = rings.anchors.patient[w]
    largest = float(0.0)
    for k in range(rings.face_start[r], rings.face_start[r + 1]):
        f = rings.face[k]
        largest = wp.max(largest, face_strain(x[f[0], w], x[f[1], w], x[f[2], w], rings.inverse[k, p]))
    pull = wp.vec3(0.0)
    for k in range(rings.anchor_start[r], rings.anchor_start[r + 1]):
        i = rings.anchored[k]
        pull += anchor_pull(rings.anchors, i, w, x[i, w])
    net = anchor_scale[w] * wp.length(pull)
    strain[r, w] = strain[r, w] + largest
    strain_peak[r, w] = wp.max(strain_peak[r, w], largest)
    tension[r, w] = tension[r, w] + net
    tension_peak[r, w] = wp.max(tension_peak[r, w], net)
