# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Measurement of a shell on a CPU: what the kernels of ``shell_kernels`` do, sixteen hinges or triangles at a time.

A core adds sixteen numbers as fast as one, but no compiler finds them where each row looks up places of its own: here
they are gathered first. Products are fused with sums as the compiler does it for ``shell_kernels``, so that the results
are the same to the bit.
"""

import warp as wp

from arcgym.sim.wall.shell_kernels import SMALLEST, STIFFENING, ShellElements
from arcgym.sim.wall.wall_kernels import Tissue
from arcgym.utils import warp_setup  # noqa: F401

LANES = 16
"""Rows at a time. Where fewer are left, the last one fills the others up."""

_GATHER = """
    typedef float lanes __attribute__((ext_vector_type(LANES)));
    struct Points {
        lanes x, y, z;
        Points operator-(const Points& o) const { return {x - o.x, y - o.y, z - o.z}; }
    };
    const auto fma = [](lanes a, lanes b, lanes c) { return __builtin_elementwise_fma(a, b, c); };
    const auto dot = [&](const Points& a, const Points& b) { return fma(a.z, b.z, fma(a.y, b.y, a.x * b.x)); };
    const auto cross = [&](const Points& a, const Points& b) {
        return Points {
            fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))
        };
    };
    const int p = shell.patient.data[w];
    int row[LANES];
    #pragma unroll
    for (int k = 0; k < LANES; ++k) row[k] = first + k < end ? first + k : end - 1;
    const auto gather = [&](const auto& value) {
        lanes out;
        #pragma unroll
        for (int k = 0; k < LANES; ++k) out[k] = value(k);
        return out;
    };
    const auto at = [](const auto& array, long long i, int j) -> auto& { return array.data[i * array.shape[1] + j]; };
    const auto points = [&](const auto& vertex) {
        Points out;
        #pragma unroll
        for (int k = 0; k < LANES; ++k) {
            const wp::vec3& one = at(x, vertex(k), w);
            out.x[k] = one[0];
            out.y[k] = one[1];
            out.z[k] = one[2];
        }
        return out;
    };
"""

_HINGES = """
    const int* const hinges = (const int*)shell.hinges.data;
    const auto corner = [&](int c) { return points([&](int k) { return hinges[4 * row[k] + c]; }); };
    const Points start = corner(2);
    const Points edge = corner(3) - start, a = corner(0) - start, b = corner(1) - start;
    const Points normal = cross(a, b);
    const lanes squared = dot(edge, edge);
    const lanes volume = fma(edge.z, normal.z, fma(edge.x, normal.x, edge.y * normal.y));
    const lanes sine = -__builtin_elementwise_sqrt(squared) * volume;
    const lanes cosine = fma(dot(a, edge), dot(b, edge), -(squared * dot(a, b)));
    const lanes span = __builtin_elementwise_sqrt(fma(cosine, cosine, sine * sine)) + cosine;
    const lanes t = sine / span, z = t * t;
    lanes series = fma(z, (lanes)8.05374449538e-2f, (lanes)-1.38776856032e-1f);
    series = fma(fma(z, series, (lanes)1.99777106478e-1f), z, (lanes)-3.33329491539e-1f);
    lanes angle = 2.0f * fma(z * series, t, t);
    const lanes steep = 0.41421356f * span;
    #pragma unroll
    for (int k = 0; k < LANES; ++k)
        if (wp::abs(sine[k]) >= steep[k]) angle[k] = wp::atan2(sine[k], cosine[k]);
    const lanes change = angle - gather([&](int k) { return at(shell.rest_angle, row[k], p); });
    #pragma unroll
    for (int k = 0; k < LANES; ++k) at(shell.angle_change, row[k], w) = change[k];
"""

_MOMENTS = """
    const long long patients = shell.coupling.shape[2];
    const lanes poisson = nu, rest = 1.0f - nu;
    lanes moment = 0.0f;
    for (int n = 0; n < 5; ++n) {
        const lanes one = gather([&](int k) { return shell.coupling.data[(5 * row[k] + n) * patients + p][0]; });
        const lanes two = gather([&](int k) { return shell.coupling.data[(5 * row[k] + n) * patients + p][1]; });
        const lanes change = gather([&](int k) {
            return at(shell.angle_change, at(shell.coupled, row[k], n), w);
        });
        const lanes weight = n == 0 ? fma(poisson, two, rest * one) : fma(rest, one, poisson * two);
        moment = fma(weight, change, moment);
    }
    #pragma unroll
    for (int k = 0; k < LANES; ++k) at(shell.moment, row[k], w) = moment[k];
"""

_TRIANGLES = """
    const int* const corners = (const int*)shell.triangles.data;
    const int* const edges = (const int*)shell.edges.data;
    const auto corner = [&](int c) { return points([&](int k) { return corners[3 * row[k] + c]; }); };
    const auto rest = [&](int c) { return gather([&](int k) { return at(shell.rest, row[k], p)[c]; }); };
    const auto bent = [&](int c) {
        return gather([&](int k) {
            const int h = edges[3 * row[k] + c];
            return h < 0 ? 0.0f : at(shell.inverse_length, h, p) * at(shell.moment, h, w);
        });
    };
    const Points start = corner(0);
    const Points d1 = corner(1) - start, d2 = corner(2) - start;
    const Points normal = cross(d1, d2);
    const lanes long2 = fma(normal.z, normal.z, fma(normal.x, normal.x, normal.y * normal.y));
    const lanes size = long2 > 1.0e-20f ? long2 : (lanes)1.0e-20f;
    const Points scaled = {normal.x / size, normal.y / size, normal.z / size};
    const lanes r0 = rest(0), r1 = rest(1), r2 = rest(2), area = rest(3);
    const lanes d11 = dot(d1, d1), d22 = dot(d2, d2), d12 = dot(d1, d2);
    const lanes unit = (4.0f * area) * area, least = SMALLESTf * unit;
    const lanes square0 = fma(d11, d22, -(d12 * d12));
    const lanes square = square0 > least ? square0 : least;
    const lanes dots1 = d11 - d12, dots2 = d22 - d12;
    const lanes trace = fma(r0, dots1 + dots2, fma(r1, d22, r2 * d11)) - 2.0f;
    const lanes excess = trace > 0.0f ? trace : (lanes)0.0f;
    const lanes shear = moduli[0] * fma(excess, STIFFENINGf * excess, (lanes)1.0f);
    const lanes ratio = square / unit, half = moduli[1] * 0.5f;
    const lanes spread = fma(gather([&](int k) { return wp::log(ratio[k]); }), half, (lanes)-moduli[0]);
    const lanes s = area * shear, tie = (area * spread) * (1.0f / square);
    const lanes pull0 = fma(s, r0, tie * d12), pull1 = fma(s, r1, tie * dots1), pull2 = fma(s, r2, tie * dots2);
    const lanes bend = unit * moduli[2];
    const lanes u0 = bent(0), u1 = bent(1), u2 = bent(2);
    const lanes turn1 = fma(r2, u1 - u0, r0 * (u1 - u2)), turn2 = fma(r0, u2 - u1, r1 * (u2 - u0));
    const auto forces = [&](lanes up, lanes a, lanes b, int c) {
        const lanes one = fma(pull0, b, fma(bend * up, turn1, -((pull2 + pull0) * a)));
        const lanes two = fma(pull0, a, fma(bend * up, turn2, -((pull1 + pull0) * b)));
        const lanes none = -one - two;
        #pragma unroll
        for (int k = 0; k < LANES; ++k) {
            at(shell.scaled_normal, row[k], w)[c] = up[k];
            at(shell.corner_force, 3 * row[k], w)[c] = none[k];
            at(shell.corner_force, 3 * row[k] + 1, w)[c] = one[k];
            at(shell.corner_force, 3 * row[k] + 2, w)[c] = two[k];
        }
    };
    forces(scaled.x, d1.x, d2.x, 0);
    forces(scaled.y, d1.y, d2.y, 1);
    forces(scaled.z, d1.z, d2.z, 2);
"""


def _on_a_cpu(code: str) -> str:
    code = (_GATHER + code).replace("LANES", str(LANES))
    code = code.replace("SMALLEST", str(float(SMALLEST))).replace("STIFFENING", str(float(STIFFENING)))
    return f"#if !defined(__CUDA_ARCH__)\n{code}\n#endif\n"


@wp.func_native(_on_a_cpu(_HINGES))
def measure_some_hinges(first: int, end: int, w: int, x: wp.array2d[wp.vec3], shell: ShellElements):
    """Write ``shell.angle_change`` of ``LANES`` hinges from ``first`` on, those before ``end``."""
    ...


@wp.func_native(_on_a_cpu(_MOMENTS))
def measure_some_moments(first: int, end: int, w: int, x: wp.array2d[wp.vec3], nu: float, shell: ShellElements):
    """Write ``shell.moment`` of ``LANES`` hinges from ``first`` on, those before ``end``."""
    ...


@wp.func_native(_on_a_cpu(_TRIANGLES))
def measure_some_triangles(first: int, end: int, w: int, x: wp.array2d[wp.vec3], moduli: wp.vec3, shell: ShellElements):
    """Write normals and corner forces of ``LANES`` triangles from ``first`` on, those before ``end``."""
    ...


@wp.kernel
def measure_hinges(first: int, rows: int, x: wp.array2d[wp.vec3], tissue: Tissue, shell: ShellElements):
    """Do as ``shell_kernels.measure_hinges`` for some ``rows``. Launch (rows over ``LANES``, rounded up, W)."""
    block, w = wp.tid()
    measure_some_hinges(first + wp.static(LANES) * block, first + rows, w, x, shell)


@wp.kernel
def measure_moments(first: int, rows: int, x: wp.array2d[wp.vec3], tissue: Tissue, shell: ShellElements):
    """Do as ``shell_kernels.measure_moments`` for some ``rows``. Launch (rows over ``LANES``, rounded up, W)."""
    block, w = wp.tid()
    moduli = tissue.moduli[w]
    nu = moduli[1] / (moduli[1] + 2.0 * moduli[0])
    measure_some_moments(first + wp.static(LANES) * block, first + rows, w, x, nu, shell)


@wp.kernel
def measure_triangles(first: int, rows: int, x: wp.array2d[wp.vec3], tissue: Tissue, shell: ShellElements):
    """Do as ``shell_kernels.measure_triangles`` for some ``rows``. Launch (rows over ``LANES``, rounded up, W)."""
    block, w = wp.tid()
    measure_some_triangles(first + wp.static(LANES) * block, first + rows, w, x, tissue.moduli[w], shell)
