# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Elements around a vertex of a shell on a GPU: what ``shell_kernels.add_elements`` does, in fewer instructions.

Half of a symmetric Hessian is added up, and places in memory are counted once a vertex. Where a triangle follows the
one across its spoke in the fan, as :func:`.shell_fans.ordered_corners` has it, two of its four vertices and one of its
three normals are at hand.
"""

import warp as wp

from arcgym.sim.wall.shell_kernels import SMALLEST, STIFFENING, ShellElements
from arcgym.sim.wall.wall_kernels import VertexBlock
from arcgym.utils import warp_setup  # noqa: F401

Sums = wp.types.vector(length=9, dtype=float)
"""Force [N], then the Hessian's diagonal and its entries xy, xz and yz [N/m]."""

_ADD = """
    using namespace wp;
    const int worlds = x.shape[1], patients = shell.fan_rest.shape[1], p = shell.patient.data[w];
    const long long step = 3 * worlds;
    const float* const points = (const float*)x.data + 3 * w;
    const float* const normals = (const float*)shell.scaled_normal.data + 3 * w;
    const float* const moments = shell.moment.data + w;
    const auto at = [&](const float* base, int row) {
        const float* const from = base + row * step;
        return vec3(from[0], from[1], from[2]);
    };
    const auto four = [](const float* from) {
#if defined(__CUDA_ARCH__)
        const float4 value = *(const float4*)from;
        return vec4(value.x, value.y, value.z, value.w);
#else
        return vec4(from[0], from[1], from[2], from[3]);
#endif
    };
    const vec3 here = at(points, i);
    const float mu = moduli[0], half_lambda = 0.5f * moduli[1], rigidity = moduli[2];
    vec3 force(0.0f, 0.0f, 0.0f);
    float diagonal = 0.0f, xx = 0.0f, yy = 0.0f, zz = 0.0f, xy = 0.0f, xz = 0.0f, yz = 0.0f;
    const auto outer_product = [&](float c, const vec3& v) {
        const float a = c * v[0], b = c * v[1], d = c * v[2];
        xx += a * v[0];
        xy += a * v[1];
        xz += a * v[2];
        yy += b * v[1];
        yz += b * v[2];
        zz += d * v[2];
    };
    const int begin = shell.fan_start.data[i], end = shell.fan_start.data[i + 1];
    int last = -1;  // triangle before, and where its other vertices are from here
    vec3 last_first(0.0f, 0.0f, 0.0f), last_second(0.0f, 0.0f, 0.0f), last_normal(0.0f, 0.0f, 0.0f);
    for (int k = begin; k < end; ++k) {
        const auto& t = shell.fan.data[k];
        const float* const own = (const float*)(shell.fan_rest.data + ((long long)k * patients + p));
        const vec4 rest = four(own), rim = four(own + 4), spoke = four(own + 8);
        vec3 d1, beyond_spoke, spoke_normal;
        if (last >= 0 && t.spoke_triangle == last) {
            d1 = last_second;
            beyond_spoke = last_first;
            spoke_normal = last_normal;
        } else {
            d1 = at(points, t.first) - here;
            beyond_spoke = at(points, t.spoke_vertex) - here;
            spoke_normal = at(normals, t.spoke_triangle);
        }
        const vec3 d2 = at(points, t.second) - here, beyond_rim = at(points, t.rim_vertex) - here;
        const vec3 normal = at(normals, t.index), rim_normal = at(normals, t.rim_triangle);
        const float rim_moment = rim[3] > 0.0f ? moments[(long long)t.rim * worlds] : 0.0f;
        const float spoke_moment = spoke[3] > 0.0f ? moments[(long long)t.spoke * worlds] : 0.0f;
        last = t.index;
        last_first = d1;
        last_second = d2;
        last_normal = normal;

        const float d11 = dot(d1, d1), d22 = dot(d2, d2), d12 = dot(d1, d2);
        const float area = rest[3], unit = 4.0f * area * area;
        const float square = wp::max(d11 * d22 - d12 * d12, SMALLEST * unit);
        const float inverse = 1.0f / square;
        const float dots1 = d11 - d12, dots2 = d22 - d12;
        const float excess = wp::max(rest[2] * d11 + rest[1] * d22 + rest[0] * (dots1 + dots2) - 2.0f, 0.0f);
        const float shear = mu * (1.0f + STIFFENING * excess * excess);
        const float spread = half_lambda * logf(square / unit) - mu;
        const float by_shear = area * shear, by_spread = area * spread * inverse;
        const float pull2 = by_shear * rest[2] + by_spread * dots2, pull1 = by_shear * rest[1] + by_spread * dots1;
        force = force + pull2 * d1 + pull1 * d2;
        const float s = by_shear * (rest[1] + rest[2]);
        const float along = area * wp::max(moduli[1] - spread, 0.0f) * inverse * inverse;
        const float across = wp::max(s + by_spread * (dots1 + dots2), 0.0f);
        diagonal += s;
        outer_product(along, dots2 * d1 + dots1 * d2);
        const float stretched = area * 4.0f * STIFFENING * mu * excess;
        if (stretched > 0.0f) outer_product(stretched, rest[2] * d1 + rest[1] * d2);
        outer_product((across - s) * inverse, cross(d1, d2));

        const float rise1 = dot(normal, d1), rise2 = dot(normal, d2);
        const float rim_lift = dot(rim_normal, beyond_rim - (1.0f - rim[2]) * d1 - rim[2] * d2)
            - (1.0f - rim[1]) * rise1 - rim[1] * rise2;
        const float rim_stiffness = rigidity * rim[3];
        const float rim_torque = rigidity * rim_moment - rim_stiffness * rim[0] * rim_lift;
        force = force + (rim_torque * rim[0]) * normal;
        outer_product(rim_stiffness * rim[0] * rim[0], normal);

        const float spoke_lift = rise2 - spoke[1] * rise1 + dot(spoke_normal, beyond_spoke - spoke[2] * d1);
        const float spoke_stiffness = rigidity * spoke[3];
        const float spoke_torque = rigidity * spoke_moment - spoke_stiffness * spoke[0] * spoke_lift;
        const vec3 turn = (1.0f - spoke[1]) * normal + (1.0f - spoke[2]) * spoke_normal;
        force = force - (spoke_torque * spoke[0]) * turn;
        outer_product(spoke_stiffness * spoke[0] * spoke[0], turn);
    }
    const float sums[9] = {force[0], force[1], force[2], diagonal + xx, diagonal + yy, diagonal + zz, xy, xz, yz};
    vec_t<9, float> out;
    for (int n = 0; n < 9; ++n) out[n] = sums[n];
    return out;
""".replace("SMALLEST", f"{float(SMALLEST)}f").replace("STIFFENING", f"{float(STIFFENING)}f")


@wp.func_native(_ADD)
def element_sums(shell: ShellElements, x: wp.array2d[wp.vec3], i: int, w: int, moduli: wp.vec3) -> Sums:
    """Return the sums over the triangles and hinges around vertex ``i`` of world ``w``."""
    ...


@wp.func
def add_elements(
    block: VertexBlock, shell: ShellElements, x: wp.array2d[wp.vec3], i: int, w: int, moduli: wp.vec3
) -> VertexBlock:
    """Add the terms of the triangles and hinges around vertex ``i`` of world ``w``."""
    sums = element_sums(shell, x, i, w, moduli)
    out = block
    out.force += wp.vec3(sums[0], sums[1], sums[2])
    out.hessian += wp.mat33(sums[3], sums[6], sums[7], sums[6], sums[4], sums[8], sums[7], sums[8], sums[5])
    return out
