# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Closest-point functions between points, segments and triangles (Ericson, Real-Time Collision Detection, ch. 5)."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.func
def segment_parameter(p: wp.vec3, a: wp.vec3, b: wp.vec3) -> float:
    """Return the parameter in [0, 1] of the point of segment ``ab`` closest to ``p``."""
    d = b - a
    return wp.clamp(wp.dot(p - a, d) / wp.max(wp.dot(d, d), 1.0e-12), 0.0, 1.0)


@wp.func
def triangle_point(a: wp.vec3, b: wp.vec3, c: wp.vec3, u: wp.vec3) -> wp.vec3:
    """Return the point of triangle ``abc`` with barycentric coordinates ``u``."""
    return u[0] * a + u[1] * b + u[2] * c


@wp.func
def corner_point(x: wp.array2d[wp.vec3], face: wp.vec3i, u: wp.vec3, w: int) -> wp.vec3:
    """Return the point of world ``w``'s triangle ``face`` at barycentric coordinates ``u``; ``x`` has shape (V, W)."""
    return triangle_point(x[face[0], w], x[face[1], w], x[face[2], w], u)


@wp.func
def closest_on_triangle(a: wp.vec3, b: wp.vec3, c: wp.vec3, p: wp.vec3) -> wp.vec3:
    """Return the barycentric coordinates of the point of triangle ``abc`` closest to ``p``."""
    ab = b - a
    ac = c - a
    d1 = wp.dot(ab, p - a)
    d2 = wp.dot(ac, p - a)
    if d1 <= 0.0 and d2 <= 0.0:
        return wp.vec3(1.0, 0.0, 0.0)
    d3 = wp.dot(ab, p - b)
    d4 = wp.dot(ac, p - b)
    if d3 >= 0.0 and d4 <= d3:
        return wp.vec3(0.0, 1.0, 0.0)
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v = d1 / (d1 - d3)
        return wp.vec3(1.0 - v, v, 0.0)
    d5 = wp.dot(ab, p - c)
    d6 = wp.dot(ac, p - c)
    if d6 >= 0.0 and d5 <= d6:
        return wp.vec3(0.0, 0.0, 1.0)
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        w = d2 / (d2 - d6)
        return wp.vec3(1.0 - w, 0.0, w)
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 >= d3 and d5 >= d6:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return wp.vec3(0.0, 1.0 - w, w)
    inv = 1.0 / (va + vb + vc)
    return wp.vec3(1.0 - (vb + vc) * inv, vb * inv, vc * inv)


@wp.func
def segment_segment(p1: wp.vec3, q1: wp.vec3, p2: wp.vec3, q2: wp.vec3) -> wp.vec2:
    """Return the parameters (on ``p1 q1``, on ``p2 q2``) of the closest points of two segments."""
    d1 = q1 - p1
    d2 = q2 - p2
    r = p1 - p2
    a = wp.max(wp.dot(d1, d1), 1.0e-12)
    e = wp.max(wp.dot(d2, d2), 1.0e-12)
    f = wp.dot(d2, r)
    c = wp.dot(d1, r)
    b = wp.dot(d1, d2)
    den = a * e - b * b
    s = float(0.5)
    if den > 1.0e-6 * a * e:
        s = wp.clamp((b * f - c * e) / den, 0.0, 1.0)
    t = (b * s + f) / e
    if t < 0.0:
        t = 0.0
        s = wp.clamp(-c / a, 0.0, 1.0)
    elif t > 1.0:
        t = 1.0
        s = wp.clamp((b - c) / a, 0.0, 1.0)
    return wp.vec2(s, t)


@wp.func
def segment_triangle(p: wp.vec3, q: wp.vec3, a: wp.vec3, b: wp.vec3, c: wp.vec3) -> wp.vec4:
    """Return the closest point of triangle ``abc`` to segment ``pq`` as (barycentric coordinates, distance [m]).

    The candidates are both ends of the segment against the face and the segment against the three edges. A segment
    that pierces the face is at distance zero from none of them; the contact's sign then comes from the wall's normal.
    """
    u = closest_on_triangle(a, b, c, p)
    best = wp.length(triangle_point(a, b, c, u) - p)
    v = closest_on_triangle(a, b, c, q)
    d = wp.length(triangle_point(a, b, c, v) - q)
    if d < best:
        best = d
        u = v
    st = segment_segment(p, q, a, b)
    d = wp.length(p + (q - p) * st[0] - a - (b - a) * st[1])
    if d < best - 1.0e-7:
        best = d
        u = wp.vec3(1.0 - st[1], st[1], 0.0)
    st = segment_segment(p, q, b, c)
    d = wp.length(p + (q - p) * st[0] - b - (c - b) * st[1])
    if d < best - 1.0e-7:
        best = d
        u = wp.vec3(0.0, 1.0 - st[1], st[1])
    st = segment_segment(p, q, c, a)
    d = wp.length(p + (q - p) * st[0] - c - (a - c) * st[1])
    if d < best - 1.0e-7:
        best = d
        u = wp.vec3(st[1], 0.0, 1.0 - st[1])
    return wp.vec4(u[0], u[1], u[2], best)


@wp.func
def blended(mean: wp.vec4, u: wp.vec3, distance: float, nearest: float, blur: float) -> wp.vec4:
    """Return the running sum of barycentric coordinates and of their weights exp(-(distance - nearest) / blur)."""
    weight = wp.exp((nearest - distance) / blur)
    return mean + weight * wp.vec4(u[0], u[1], u[2], 1.0)


@wp.func
def segment_triangle_mean(
    p: wp.vec3, q: wp.vec3, a: wp.vec3, b: wp.vec3, c: wp.vec3, nearest: float, blur: float
) -> wp.vec3:
    """Return barycentric coordinates of triangle ``abc`` close to segment ``pq``, whose distance is ``nearest`` [m].

    The mean of the candidates of :func:`segment_triangle` by their nearness: unlike the closest point itself, it does
    not jump from edge to edge of a triangle that is parallel to the segment. ``blur`` [m] is how much farther a
    candidate may be and still count.
    """
    u = closest_on_triangle(a, b, c, p)
    mean = blended(wp.vec4(0.0), u, wp.length(triangle_point(a, b, c, u) - p), nearest, blur)
    u = closest_on_triangle(a, b, c, q)
    mean = blended(mean, u, wp.length(triangle_point(a, b, c, u) - q), nearest, blur)
    st = segment_segment(p, q, a, b)
    d = wp.length(p + (q - p) * st[0] - a - (b - a) * st[1])
    mean = blended(mean, wp.vec3(1.0 - st[1], st[1], 0.0), d, nearest, blur)
    st = segment_segment(p, q, b, c)
    d = wp.length(p + (q - p) * st[0] - b - (c - b) * st[1])
    mean = blended(mean, wp.vec3(0.0, 1.0 - st[1], st[1]), d, nearest, blur)
    st = segment_segment(p, q, c, a)
    d = wp.length(p + (q - p) * st[0] - c - (a - c) * st[1])
    mean = blended(mean, wp.vec3(st[1], 0.0, 1.0 - st[1]), d, nearest, blur)
    return wp.vec3(mean[0], mean[1], mean[2]) / mean[3]
