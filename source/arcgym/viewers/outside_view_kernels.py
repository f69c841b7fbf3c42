# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels of the outside view: a ray marcher through the translucent wall, and its edge anti-aliasing."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

MAX_HITS = wp.constant(24)
"""Layers of wall that a ray goes through, at most."""
FAR = wp.constant(10.0)
"""Distance of where nothing was hit [m]."""


@wp.struct
class ViewParams:
    """Camera, light and look of one frame; vectors in world coordinates."""

    eye: wp.vec3
    right: wp.vec3
    """Right vector times the tangent of half the horizontal field of view."""
    up: wp.vec3
    """Up vector times the tangent of half the vertical field of view."""
    forward: wp.vec3
    key_light: wp.vec3
    """Unit vector towards the key light."""
    fill_light: wp.vec3
    """Unit vector towards the fill light."""
    width: int
    height: int
    near_alpha: float
    """Opacity of a wall that is seen face on from outside."""
    rim_alpha: float
    """Opacity added towards the silhouette."""
    far_alpha: float
    """Opacity of a wall that is seen from the lumen."""
    ghost_alpha: float
    """Opacity of a wall that is seen from the lumen and has the scope behind it."""
    scope_share: float
    """Smallest share of the scope in the color of a pixel that it lies behind."""
    table_step: float
    """Arc length between two entries of the scope's color table [m]."""


@wp.struct
class ViewGeometry:
    """Things drawn: the wall of one world and the scope."""

    wall: wp.uint64
    """Mesh of the wall."""
    root: wp.array[int]
    """Where ray queries of the drawn world start in the wall's mesh, shape (1,)."""
    wall_normals: wp.array[wp.vec3]
    """Unit normals towards the lumen, one for each wall vertex."""
    wall_colors: wp.array[wp.vec3]
    """Linear RGB of each wall vertex."""
    scope: wp.uint64
    """Mesh of the scope."""
    scope_normals: wp.array[wp.vec3]
    """Unit normals outwards, one for each scope vertex."""
    scope_arcs: wp.array[float]
    """Distance of each scope vertex from the proximal end, along the scope [m]."""
    scope_table: wp.array[wp.vec3]
    """Linear RGB along the scope, an entry every ``ViewParams.table_step``."""


@wp.struct
class Sample:
    """Result of one ray."""

    color: wp.vec4
    """Linear RGB, premultiplied, and opacity."""
    depth: float
    """Distance to the first hit [m]; FAR where there is none."""


@wp.func
def half_lambert(normal: wp.vec3, light: wp.vec3):
    """Soft diffuse term in 0..1 that does not fall to black at the terminator (Valve, "half-Lambert", 2004)."""
    shade = 0.5 + 0.5 * wp.dot(normal, light)
    return shade * shade


@wp.func
def gloss(normal: wp.vec3, light: wp.vec3, ray: wp.vec3, power: float):
    """Blinn-Phong highlight in 0..1."""
    halfway = wp.normalize(light - ray)
    return wp.pow(wp.max(wp.dot(normal, halfway), 0.0), power)


@wp.func
def shade_scope(base: wp.vec3, normal: wp.vec3, ray: wp.vec3, view: ViewParams):
    """Satin plastic: diffuse, one highlight, and a light edge that lifts the dark shaft off its surroundings."""
    diffuse = 0.25 + 0.85 * half_lambert(normal, view.key_light) + 0.20 * half_lambert(normal, view.fill_light)
    edge = wp.pow(1.0 - wp.abs(wp.dot(normal, ray)), 3.0)
    shine = 0.45 * gloss(normal, view.key_light, ray, 50.0) + 0.10 * edge
    return base * diffuse + wp.vec3(shine, shine, shine)


@wp.func
def scope_color(
    geometry: ViewGeometry,
    query: wp.MeshQueryRay,
    ray: wp.vec3,
    view: ViewParams,
):
    """Shade the scope at a ray hit."""
    i = wp.mesh_get_index(geometry.scope, query.face * 3)
    j = wp.mesh_get_index(geometry.scope, query.face * 3 + 1)
    k = wp.mesh_get_index(geometry.scope, query.face * 3 + 2)
    a = query.u
    b = query.v
    c = 1.0 - query.u - query.v
    normals = geometry.scope_normals
    arcs = geometry.scope_arcs
    normal = wp.normalize(normals[i] * a + normals[j] * b + normals[k] * c)
    arc = arcs[i] * a + arcs[j] * b + arcs[k] * c
    entry = wp.clamp(int(arc / view.table_step), 0, geometry.scope_table.shape[0] - 1)
    return shade_scope(geometry.scope_table[entry], normal, ray, view)


@wp.func
def outer_wall(base: wp.vec3, normal: wp.vec3, ray: wp.vec3, view: ViewParams):
    """Color (premultiplied) and opacity of the wall seen from outside; `normal` points out of the colon."""
    facing = wp.abs(wp.dot(normal, ray))
    alpha = wp.min(view.near_alpha + view.rim_alpha * wp.pow(1.0 - facing, 2.0), 0.97)
    light = 0.18 + 0.90 * half_lambert(normal, view.key_light) + 0.14 * half_lambert(normal, view.fill_light)
    shine = 0.30 * gloss(normal, view.key_light, ray, 45.0) + 0.05 * gloss(normal, view.fill_light, ray, 20.0)
    color = base * (light * alpha) + wp.vec3(shine, shine, shine)
    return wp.vec4(color[0], color[1], color[2], wp.min(alpha + shine, 1.0))


@wp.func
def inner_wall(base: wp.vec3, normal: wp.vec3, ray: wp.vec3, alpha: float, view: ViewParams):
    """Color (premultiplied) and opacity of the wall seen from the lumen; `normal` points into the lumen."""
    facing = wp.abs(wp.dot(normal, ray))
    light = (0.42 + 0.60 * half_lambert(normal, view.key_light)) * (0.55 + 0.45 * facing)
    color = base * (light * alpha)
    return wp.vec4(color[0], color[1], color[2], alpha)


@wp.func
def trace(
    x: float,
    y: float,
    geometry: ViewGeometry,
    view: ViewParams,
):
    """Follow the ray through picture position (x, y) [px] front to back until the scope or full opacity."""
    across = 2.0 * x / float(view.width) - 1.0
    down = 2.0 * y / float(view.height) - 1.0
    ray = wp.normalize(view.forward + view.right * across - view.up * down)
    result = Sample()
    result.depth = FAR
    color = wp.vec3(0.0, 0.0, 0.0)
    clear = wp.float32(1.0)
    end = wp.float32(FAR)
    inner_alpha = view.far_alpha

    hit = wp.mesh_query_ray(geometry.scope, view.eye, ray, end)
    if hit.result:
        end = hit.t
        result.depth = hit.t
        inner_alpha = view.ghost_alpha

    at = wp.float32(0.0)
    count = wp.int32(0)
    while count < MAX_HITS and clear > 0.03:
        query = wp.mesh_query_ray(geometry.wall, view.eye + ray * at, ray, end - at, geometry.root[0])
        if not query.result:
            break
        at = at + query.t + 2.0e-5
        if count == 0:
            result.depth = at
        i = wp.mesh_get_index(geometry.wall, query.face * 3)
        j = wp.mesh_get_index(geometry.wall, query.face * 3 + 1)
        k = wp.mesh_get_index(geometry.wall, query.face * 3 + 2)
        c = 1.0 - query.u - query.v
        normals = geometry.wall_normals
        colors = geometry.wall_colors
        normal = wp.normalize(normals[i] * query.u + normals[j] * query.v + normals[k] * c)
        base = colors[i] * query.u + colors[j] * query.v + colors[k] * c
        layer = wp.vec4()
        if wp.dot(normal, ray) > 0.0:
            layer = outer_wall(base, -normal, ray, view)
        else:
            layer = inner_wall(base, normal, ray, inner_alpha, view)
        color += wp.vec3(layer[0], layer[1], layer[2]) * clear
        clear = clear * (1.0 - layer[3])
        count += 1

    if hit.result:
        share = wp.max(clear, view.scope_share)
        color = color * ((1.0 - share) / wp.max(1.0 - clear, 1.0e-4))
        color += scope_color(geometry, hit, ray, view) * share
        clear = 0.0
    result.color = wp.vec4(color[0], color[1], color[2], 1.0 - clear)
    return result


@wp.kernel
def trace_pixels(
    geometry: ViewGeometry,
    view: ViewParams,
    color: wp.array2d[wp.vec4],
    depth: wp.array2d[float],
):
    """Trace one ray through the middle of every pixel."""
    row, column = wp.tid()
    sample = trace(float(column) + 0.5, float(row) + 0.5, geometry, view)
    color[row, column] = sample.color
    depth[row, column] = sample.depth


@wp.func
def contrast(color: wp.array2d[wp.vec4], row: int, column: int):
    """Largest difference between a pixel and its four neighbors."""
    here = color[row, column]
    biggest = wp.float32(0.0)
    for k in range(4):
        r = wp.clamp(row + (k % 2) * (k - 2), 0, color.shape[0] - 1)
        c = wp.clamp(column + ((k + 1) % 2) * (k - 1), 0, color.shape[1] - 1)
        gap = color[r, c] - here
        biggest = wp.max(biggest, wp.max(wp.abs(gap)))
    return biggest


@wp.kernel
def refine_edges(
    geometry: ViewGeometry,
    view: ViewParams,
    threshold: float,
    color: wp.array2d[wp.vec4],
    refined: wp.array2d[wp.vec4],
):
    """Copy flat pixels and average four rotated-grid samples where neighbors differ by more than `threshold`."""
    row, column = wp.tid()
    if contrast(color, row, column) < threshold:
        refined[row, column] = color[row, column]
        return
    total = wp.vec4(0.0, 0.0, 0.0, 0.0)
    for k in range(4):
        x = 0.125 + 0.25 * float((2 * k + 1) % 5)
        y = 0.125 + 0.25 * float(k)
        sample = trace(float(column) + x, float(row) + y, geometry, view)
        total += sample.color
    refined[row, column] = total * 0.25
