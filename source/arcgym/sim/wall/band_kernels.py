# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Stiffness of the wall's bands in the modes of their two rings, at the present shape.

A band is what lies between a ring and the next one. A ring moves by x_i += t + p_i g_p + q_i g_q, with the in-plane
coordinates (p, q) that its vertices have at rest. Moving both rings alike strains nothing, so that a band's energy has
five vectors: how far the ring's t is from the next one's, its g_p and g_q, and those of the next ring. In every element
each of them moves the corners by a number times the vector; only differences of the numbers along the edges count.

Bending along the colon joins three rings, which a system of neighbors cannot hold: a band has a bound of it, see
``ring_modes.bending_bound``, with the rings' widening and flattening measured in the plane in which each lies now.
"""

import warp as wp

from arcgym.sim.wall.band_matrix_kernels import BandMatrix, Five, add_strain_difference, write_band
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.warp_setup import FAST, GPU_BLOCK


@wp.struct
class Rings:
    """Rings of the wall of each of P patients, and the elements of the bands between them."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    ring: wp.array[int]  # ring of each vertex, shape (V,)
    plane: wp.array2d[wp.vec2]  # in-plane coordinates (p, q) of each vertex over the ring's rms radius, shape (V, P)
    bending: wp.array2d[wp.mat33]  # factor of each band's bound on bending, see ring_modes [1/m], shape (R, P)
    moves: wp.array2d[int]  # 1 where a whole ring moves, shape (R, P)
    band_start: wp.array[int]  # first element of each ring's band, shape (R + 1,)
    band: wp.array[int]  # elements, sorted by band, shape (E,)


@wp.func
def band_fields(rings: Rings, i: int, r: int, p: int) -> Five:
    """Return the five fields of the band of ring ``r`` at vertex ``i`` of patient ``p``."""
    plane = rings.plane[i, p]
    if rings.ring[i] == r:
        return Five(1.0, plane[0], plane[1], 0.0, 0.0)
    return Five(0.0, 0.0, 0.0, plane[0], plane[1])


@wp.struct
class RingAxes:
    """Directions in which the in-plane coordinates of each ring point now, shape (R, W)."""

    p: wp.array2d[wp.vec3]
    q: wp.array2d[wp.vec3]


@wp.func
def add_bending(band: BandMatrix, axes: RingAxes, factor: wp.mat33, rigidity: float, r: int, w: int) -> BandMatrix:
    """Add the bound on the bending along the colon: springs on mixtures of widening and flattening.

    Args:
        band: Matrix of the band.
        axes: Directions of the rings.
        factor: Its columns are the mixtures [1/m].
        rigidity: Flexural rigidity [N m].
        r: Ring of the band.
        w: World.
    """
    p = axes.p[r, w]
    q = axes.q[r, w]
    next_p = axes.p[r + 1, w]
    next_q = axes.q[r + 1, w]
    out = band
    for k in range(3):
        along = factor[0, k] + factor[1, k]
        across = factor[0, k] - factor[1, k]
        mixed = factor[2, k]
        out = add_strain_difference(
            out,
            rigidity,
            along * p + mixed * q,
            across * q + mixed * p,
            along * next_p + mixed * next_q,
            across * next_q + mixed * next_p,
        )
    return out


def band_kernel(elements_type: type, add_element: wp.Function, changed_alone: bool = False) -> wp.Kernel:
    """Make the kernel that measures the bands' stiffness, for one kind of elements.

    Args:
        elements_type: Struct of the elements.
        add_element: Adds an element to a band's matrix, at the present positions; takes matrix, elements, rings,
            positions, element, ring, world and moduli.
        changed_alone: Whether to leave the bands out of which neither ring has changed.
    """

    @wp.kernel(module="unique", launch_bounds=(GPU_BLOCK, 3), module_options=FAST)
    def measure_bands(
        first: int,
        x: wp.array2d[wp.vec3],
        elements: elements_type,
        rings: Rings,
        axes: RingAxes,
        tissue: Tissue,
        changed: wp.array2d[int],
        bands: wp.array4d[float],
    ):
        """Measure the stiffness of every band. Launch (R - 1, W), or some of the rows.

        Args:
            first: First row of this launch.
            x: Positions [m], shape (V, W).
            elements: Elements of all patients.
            rings: Rings of all patients.
            axes: Directions of the rings.
            tissue: Values of each world.
            changed: 1 where a ring has changed, else 0, shape (R, W); read if ``changed_alone``.
            bands: Stiffness of each band between its unknowns [N/m], upper half, shape (R, 15, 15, W); written.
        """
        r, w = wp.tid()
        r += first
        if wp.static(changed_alone):
            if changed[r, w] == 0 and changed[r + 1, w] == 0:
                return
        band = BandMatrix()
        for e in range(rings.band_start[r], rings.band_start[r + 1]):
            band = add_element(band, elements, rings, x, rings.band[e], r, w, tissue.moduli[w])
        band = add_bending(band, axes, rings.bending[r, rings.patient[w]], tissue.moduli[w][2], r, w)
        write_band(bands, r, w, band)

    return measure_bands
