# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Measurement of a shell on a GPU: what the kernels of ``shell_kernels`` do, in fewer instructions.

They are many threads of little work each, most of which finds places in memory: here each is found by one product.
"""

import warp as wp

from arcgym.sim.wall.shell_kernels import SMALLEST, STIFFENING, ShellElements
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.warp_setup import FAST

_PLACES = """
    using namespace wp;
    const unsigned worlds = shell.scaled_normal.shape[1];
    const auto at = [&](const float* base, unsigned row) {
        const float* const from = base + (row * worlds + w) * 3u;
        return vec3(from[0], from[1], from[2]);
    };
    const auto put = [&](float* base, unsigned row, const vec3& v) {
        float* const to = base + (row * worlds + w) * 3u;
        to[0] = v[0];
        to[1] = v[1];
        to[2] = v[2];
    };
"""

_HINGE = (
    _PLACES
    + """
    const float* const points = (const float*)x.data;
    const int* const c = (const int*)shell.hinges.data + 4 * h;
    const vec3 start = at(points, c[2]);
    const vec3 edge = at(points, c[3]) - start, a = at(points, c[0]) - start, b = at(points, c[1]) - start;
    const float squared = dot(edge, edge);
    const float sine = -sqrtf(squared) * dot(edge, cross(a, b));
    const float cosine = dot(a, edge) * dot(b, edge) - squared * dot(a, b);
    const float span = sqrtf(sine * sine + cosine * cosine) + cosine;
    float angle;
    if (fabsf(sine) >= 0.41421356f * span) {
        angle = atan2f(sine, cosine);
    } else {
        const float t = sine / span, z = t * t;
        const float high = (8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f;
        angle = 2.0f * (t + (high * z - 3.33329491539e-1f) * z * t);
    }
    const unsigned patients = shell.rest_angle.shape[1], p = shell.patient.data[w];
    shell.angle_change.data[h * worlds + w] = angle - shell.rest_angle.data[h * patients + p];
"""
)

_MOMENT = (
    _PLACES
    + """
    const unsigned patients = shell.coupling.shape[2], p = shell.patient.data[w];
    const int* const c = shell.coupled.data + 5u * h;
    const float* const k = (const float*)shell.coupling.data + 2u * (5u * h * patients + p);
    float sum = 0.0f;
    for (int j = 0; j < 5; ++j) {
        const float weight = (1.0f - nu) * k[2u * j * patients] + nu * k[2u * j * patients + 1u];
        sum += weight * shell.angle_change.data[(unsigned)c[j] * worlds + w];
    }
    shell.moment.data[h * worlds + w] = sum;
"""
)

_TRIANGLE = (
    (
        _PLACES
        + """
    const float* const points = (const float*)x.data;
    const unsigned patients = shell.rest.shape[1], p = shell.patient.data[w];
    const int* const c = (const int*)shell.triangles.data + 3 * t;
    const int* const e = (const int*)shell.edges.data + 3 * t;
    const vec3 x0 = at(points, c[0]);
    const vec3 d1 = at(points, c[1]) - x0, d2 = at(points, c[2]) - x0;
    const vec3 normal = cross(d1, d2);
    const vec3 scaled = (1.0f / wp::max(dot(normal, normal), 1.0e-20f)) * normal;
    put((float*)shell.scaled_normal.data, t, scaled);
    const auto own = shell.rest.data[t * patients + p];
    const float r0 = own[0], r1 = own[1], r2 = own[2], area = own[3];
    const auto moment = [&](int h) {
        if (h < 0) return 0.0f;
        return shell.inverse_length.data[h * patients + p] * shell.moment.data[h * worlds + w];
    };
    const float u0 = moment(e[0]), u1 = moment(e[1]), u2 = moment(e[2]);
    const float d11 = dot(d1, d1), d22 = dot(d2, d2), d12 = dot(d1, d2), unit = 4.0f * area * area;
    const float square = wp::max(d11 * d22 - d12 * d12, SMALLEST * unit);
    const float dots1 = d11 - d12, dots2 = d22 - d12;
    const float excess = wp::max(r2 * d11 + r1 * d22 + r0 * (dots1 + dots2) - 2.0f, 0.0f);
    const float s = area * moduli[0] * (1.0f + STIFFENING * excess * excess);
    const float k = area * (0.5f * moduli[1] * logf(square / unit) - moduli[0]) / square;
    const float pull0 = s * r0 + k * d12, pull1 = s * r1 + k * dots1, pull2 = s * r2 + k * dots2;
    const float bend = unit * moduli[2];
    const vec3 one = (bend * (r2 * (u1 - u0) + r0 * (u1 - u2))) * scaled - (pull2 + pull0) * d1 + pull0 * d2;
    const vec3 two = (bend * (r0 * (u2 - u1) + r1 * (u2 - u0))) * scaled - (pull1 + pull0) * d2 + pull0 * d1;
    float* const forces = (float*)shell.corner_force.data;
    put(forces, 3u * t, -one - two);
    put(forces, 3u * t + 1u, one);
    put(forces, 3u * t + 2u, two);
"""
    )
    .replace("SMALLEST", f"{float(SMALLEST)}f")
    .replace("STIFFENING", f"{float(STIFFENING)}f")
)


@wp.func_native(_HINGE)
def measure_hinge(shell: ShellElements, x: wp.array2d[wp.vec3], h: int, w: int):
    """Write ``shell.angle_change[h, w]``."""
    ...


@wp.func_native(_MOMENT)
def measure_moment(shell: ShellElements, h: int, w: int, nu: float):
    """Write ``shell.moment[h, w]``."""
    ...


@wp.func_native(_TRIANGLE)
def measure_triangle(shell: ShellElements, x: wp.array2d[wp.vec3], t: int, w: int, moduli: wp.vec3):
    """Write ``shell.scaled_normal[t, w]`` and the forces on its corners."""
    ...


@wp.kernel(module="unique", module_options=FAST)
def measure_hinges(first: int, x: wp.array2d[wp.vec3], shell: ShellElements):
    """Do as ``shell_kernels.measure_hinges``. Launch (H, W)."""
    h, w = wp.tid()
    measure_hinge(shell, x, first + h, w)


@wp.kernel(module="unique", module_options=FAST)
def measure_moments(first: int, tissue: Tissue, shell: ShellElements):
    """Do as ``shell_kernels.measure_moments``. Launch (H, W)."""
    h, w = wp.tid()
    moduli = tissue.moduli[w]
    measure_moment(shell, first + h, w, moduli[1] / (moduli[1] + 2.0 * moduli[0]))


@wp.kernel(module="unique", module_options=FAST)
def measure_triangles(first: int, x: wp.array2d[wp.vec3], tissue: Tissue, shell: ShellElements):
    """Do as ``shell_kernels.measure_triangles``. Launch (F, W)."""
    t, w = wp.tid()
    measure_triangle(shell, x, first + t, w, tissue.moduli[w])
