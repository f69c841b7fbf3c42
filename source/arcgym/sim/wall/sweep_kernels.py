# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Sweep and total force of a wall, the same for elements of every kind."""

from typing import NamedTuple

import warp as wp

from arcgym.sim.wall.packed_contact_kernels import add_packed
from arcgym.sim.wall.wall_kernels import (
    MeasuredContacts,
    Tissue,
    VertexBlock,
    WallContacts,
    WallNodes,
    add_contact,
    add_outer_force,
    add_self_contact,
    converged,
    inertia_and_anchor,
    vertex_contact_force,
)
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.math_kernels import clamp_length
from arcgym.utils.warp_setup import FAST


class SweepKernels(NamedTuple):
    """Kernels of a wall for one kind of elements."""

    sweep_color: wp.Kernel
    """Newton step of the vertices of one color."""
    residual: wp.Kernel
    """Total force on every vertex."""
    sweep_packed: wp.Kernel
    """Does as ``sweep_color``, on a GPU, with contacts that were packed, see :mod:`.packed_contact_kernels`."""


def sweep_kernels(
    elements_type: type,
    add_elements: wp.Function,
    add_forces: wp.Function,
    surrounded: bool = False,
    on_gpu: wp.Function | None = None,
) -> SweepKernels:
    """Make the kernels for one kind of elements.

    On a GPU reciprocals, roots, exponentials and logarithms are those of the hardware, which are off by a few units in
    the last place: less than what the rounding of positions does to differences between them.

    Args:
        elements_type: Struct of the elements.
        add_elements: Adds force and Hessian of the elements around a vertex to its block, at the present positions;
            takes block, elements, positions, vertex, world and moduli.
        add_forces: Adds the forces alone, where the elements were measured; takes the same.
        surrounded: Whether to add ``contacts.outer``.
        on_gpu: Does as ``add_elements``, faster on a GPU, if there is such.
    """
    return SweepKernels(
        _sweep_kernel(elements_type, add_elements, surrounded, add_contact, {}),
        _residual_kernel(elements_type, add_forces, surrounded),
        _sweep_kernel(elements_type, on_gpu or add_elements, surrounded, add_packed, FAST),
    )


def _sweep_kernel(
    elements_type: type,
    add_elements: wp.Function,
    surrounded: bool,
    add_contacts: wp.Function,
    options: dict[str, bool],
) -> wp.Kernel:
    @wp.kernel(module="unique", module_options=options)
    def sweep_color(
        color: wp.array[int],
        nodes: WallNodes,
        elements: elements_type,
        tissue: Tissue,
        inertial: wp.array2d[wp.vec3],
        contacts: WallContacts,
        largest_move: float,
        rounding: wp.array[float],
        force: wp.array2d[wp.vec3],
        x: wp.array2d[wp.vec3],
    ):
        """Make one Newton step of every vertex of one color. Launch (C, W).

        Args:
            color: Vertices that share no element, shape (C,).
            nodes: Vertices of all patients.
            elements: Elements of all patients.
            tissue: Values of each world.
            inertial: Positions that inertia pulls to [m], shape (V, W).
            contacts: Contacts of this step.
            largest_move: Longest displacement of a vertex [m].
            rounding: Force over shear modulus that is rounding alone [m], of a solid [m^2], shape (P,).
            force: Residual of each vertex [N], shape (V, W).
            x: Positions [m], shape (V, W); moved in place.
        """
        k, w = wp.tid()
        i = color[k]
        noise = rounding[nodes.patient[w]] * tissue.moduli[w][0]
        if tissue.rigid[w] == 1 or converged(force[i, w], x[i, w] - inertial[i, w], noise):
            return
        block = inertia_and_anchor(nodes, tissue, inertial[i, w], x[i, w], i, w, 1.0 / (contacts.dt * contacts.dt))
        block = add_elements(block, elements, x, i, w, tissue.moduli[w])
        block = add_contacts(block, contacts, x, i, w)
        block = add_self_contact(block, contacts.self_contact, x[i, w], i, w)
        if wp.static(surrounded):
            block = add_outer_force(block, contacts.outer, x[i, w], i, w)
        x[i, w] = x[i, w] + clamp_length(wp.inverse(block.hessian) * block.force, largest_move)

    return sweep_color


def _residual_kernel(elements_type: type, add_forces: wp.Function, surrounded: bool) -> wp.Kernel:
    @wp.kernel(module="unique")
    def residual(
        first: int,
        nodes: WallNodes,
        elements: elements_type,
        tissue: Tissue,
        inertial: wp.array2d[wp.vec3],
        contacts: WallContacts,
        measured: MeasuredContacts,
        x: wp.array2d[wp.vec3],
        force: wp.array2d[wp.vec3],
    ):
        """Compute the total force on every mobile vertex where elements and contacts were measured.

        Launch (V, W), or some of the rows.

        Args:
            first: First row of this launch.
            nodes: Vertices of all patients.
            elements: Elements of all patients, measured.
            tissue: Values of each world.
            inertial: Positions that inertia pulls to [m], shape (V, W).
            contacts: Contacts of this step.
            measured: The same, measured.
            x: Positions [m], shape (V, W).
            force: Force [N], shape (V, W); written.
        """
        i, w = wp.tid()
        i += first
        block = VertexBlock()
        if nodes.mobile[i, nodes.patient[w]] == 1 and tissue.rigid[w] == 0:
            block = inertia_and_anchor(nodes, tissue, inertial[i, w], x[i, w], i, w, 1.0 / (contacts.dt * contacts.dt))
            block = add_forces(block, elements, x, i, w, tissue.moduli[w])
            block.force += vertex_contact_force(contacts.records, measured, i, w)
            block = add_self_contact(block, contacts.self_contact, x[i, w], i, w)
            if wp.static(surrounded):
                block = add_outer_force(block, contacts.outer, x[i, w], i, w)
        force[i, w] = block.force

    return residual
