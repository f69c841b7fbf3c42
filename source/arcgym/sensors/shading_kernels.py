# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Light on wet mucosa, as Warp functions shared by the policy camera and the video camera."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

EDGE = wp.constant(1.0e-5)
"""Least barycentric coordinate of a hit that counts as inside a triangle; rounding moves an edge by less."""
ASIDE = wp.constant(wp.vec3(6.0e-5, 5.0e-5, 6.2e-5))
"""What is added to the direction of a ray that meets an edge [rad]: 1/200 of a pixel where 84 make a row, which moves
a hit within its triangle by far more than EDGE."""


@wp.struct
class SurfaceView:
    """A :class:`SkinnedSurface` and its textures, for ray casting. W worlds, P patients, M vertices."""

    mesh: wp.uint64  # grouped by world
    roots: wp.array[int]  # root of each world's group, shape (W,)
    normals: wp.array[wp.vec3]  # unit normals towards the lumen, shape (W*M,)
    patient: wp.array[int]  # patient of each world, shape (W,)
    attributes: wp.array2d[wp.vec4]  # u, v, tint and texels per meter of every vertex of each patient, shape (M, P)
    albedo: wp.array[wp.Texture2D]  # color, shape (P,)
    detail: wp.array[wp.Texture2D]  # slope, height and wetness, shape (P,)
    texture_size: wp.array[wp.vec2]  # length of the texture along u and v at its true scale [m], shape (P,)


@wp.struct
class Lighting:
    """The values of :class:`LightingCfg`, with the lights placed in the camera's frame."""

    left: wp.vec3
    right: wp.vec3
    wrap: wp.vec3
    beam: float
    concentration: float
    scatter: float
    bump: float
    film: float
    gloss: float
    roughness_sq: float
    min_distance_sq: float
    pixel_angle: float


@wp.struct
class RayHit:
    """The triangle that a ray meets."""

    face: int  # -1 for none
    t: float  # distance along the ray [m]
    u: float  # share of the first corner
    v: float  # share of the second corner


@wp.struct
class Hit:
    """The surface where a ray meets it."""

    position: wp.vec3
    # geometric smooth normal, turned to the viewer
    normal: wp.vec3
    # surface gradients of the texture coordinates [1/m]
    gradient_u: wp.vec3
    gradient_v: wp.vec3
    uv: wp.vec2
    tint: float
    # level of the texture pyramid whose texels are as large as the pixel
    level: float


@wp.func
def nearest_hit(surface: SurfaceView, world: int, origin: wp.vec3, direction: wp.vec3, far: float) -> RayHit:
    """Return the nearest triangle of a world that a ray meets within ``far`` [m], whatever the order of the triangles.

    A ray that meets an edge meets two triangles at the same distance, of which a tree gives the one that it comes to
    first; trees of other patients beside have another order. So such a ray is traced again, a little aside. The query
    stands in the code once: a thread of a GPU then needs fewer registers.
    """
    hit = RayHit()
    towards = direction
    tries = wp.int32(2)
    while tries > 0:
        query = wp.mesh_query_ray(surface.mesh, origin, towards, far, surface.roots[world])
        tries -= 1
        hit.face = -1
        if query.result:
            hit.face = query.face
            hit.t = query.t
            hit.u = query.u
            hit.v = query.v
        if not query.result or wp.min(wp.min(query.u, query.v), 1.0 - query.u - query.v) >= EDGE:
            tries = 0
        towards = wp.normalize(direction + ASIDE)
    return hit


@wp.func
def surface_hit(
    surface: SurfaceView,
    face: int,
    place: wp.vec3,
    world: int,
    origin: wp.vec3,
    direction: wp.vec3,
    pixel_angle: float,
) -> Hit:
    """Interpolate the surface where a ray meets a triangle: ``place`` is the distance [m] and two corners' shares."""
    corner = face * 3
    i0 = wp.mesh_get_index(surface.mesh, corner)
    i1 = wp.mesh_get_index(surface.mesh, corner + 1)
    i2 = wp.mesh_get_index(surface.mesh, corner + 2)
    w0 = place[1]
    w1 = place[2]
    w2 = 1.0 - w0 - w1
    first = world * surface.attributes.shape[0]
    p = surface.patient[world]
    a0 = surface.attributes[i0 - first, p]
    a1 = surface.attributes[i1 - first, p]
    a2 = surface.attributes[i2 - first, p]
    at = a0 * w0 + a1 * w1 + a2 * w2

    p0 = wp.mesh_get_point(surface.mesh, corner)
    e1 = wp.mesh_get_point(surface.mesh, corner + 1) - p0
    e2 = wp.mesh_get_point(surface.mesh, corner + 2) - p0
    area = wp.cross(e1, e2)
    scale = 1.0 / wp.max(wp.length_sq(area), 1.0e-24)
    d1 = a1 - a0
    d2 = a2 - a0

    hit = Hit()
    hit.position = origin + direction * place[0]
    hit.gradient_u = wp.cross(e2 * d1[0] - e1 * d2[0], area) * scale
    hit.gradient_v = wp.cross(e2 * d1[1] - e1 * d2[1], area) * scale
    hit.uv = wp.vec2(at[0], at[1])
    hit.tint = at[2]
    normal = wp.normalize(surface.normals[i0] * w0 + surface.normals[i1] * w1 + surface.normals[i2] * w2)
    hit.normal = facing_normal(normal, area, direction)
    # sharper than the pixel's long side at a slant, coarser than its short one
    slant = wp.sqrt(wp.max(-wp.dot(hit.normal, direction), 0.05))
    hit.level = wp.log2(wp.max(0.7 * at[3] * place[0] * pixel_angle / slant, 1.0))
    return hit


@wp.func
def facing_normal(normal: wp.vec3, area: wp.vec3, direction: wp.vec3) -> wp.vec3:
    """Return the smooth normal on the viewer's side; at silhouettes, where it points away, bent back to grazing."""
    side = normal
    if wp.dot(area, direction) > 0.0:
        side = -normal
    facing = -wp.dot(side, direction)
    if facing < 0.1:
        side = wp.normalize(side - direction * (0.1 - facing))
    return side


@wp.func
def relief_normal(hit: Hit, slope: wp.vec2, texture_size: wp.vec2, height: float) -> wp.vec3:
    """Return the normal of the mucosal relief; it is flatter where the texture is stretched, as a real one would be."""
    gradient = (hit.gradient_u * (slope[0] * texture_size[0]) + hit.gradient_v * (slope[1] * texture_size[1])) * height
    steep = wp.length_sq(gradient)
    if steep > 0.25:
        gradient = gradient * (0.5 / wp.sqrt(steep))
    return wp.normalize(hit.normal - gradient)


@wp.func
def mucosa_color(texel: wp.vec4, tint: float) -> wp.vec3:
    """Return the linear albedo from a texel in gamma 2; polyps are redder, the inside of a diverticulum darker."""
    color = wp.vec3(texel[0] * texel[0], texel[1] * texel[1], texel[2] * texel[2])
    if tint > 0.0:
        return wp.cw_mul(color, wp.vec3(1.0 + 0.05 * tint, 1.0 - 0.38 * tint, 1.0 - 0.30 * tint))
    return color * (1.0 + 0.82 * tint)


@wp.func
def highlight(cosine: float, alpha_sq: float) -> float:
    """Return the GGX distribution of microfacets (Walter et al. 2007, eq. 33) times 0.01, a quarter of water's 4 %."""
    spread = cosine * cosine * (alpha_sq - 1.0) + 1.0
    return 0.01 * alpha_sq / (spread * spread)


@wp.func
def beam_power(cosine: float, lighting: Lighting) -> float:
    """Return the power of one of two lights in a direction by its angle to the axis: a diode, or a beam."""
    c = wp.max(cosine, 0.02)
    return 0.5 * c * (1.0 - lighting.beam + lighting.beam * c)


@wp.func
def measured_power(cosine: float, lighting: Lighting) -> float:
    """Return the same of a light whose fall-off was measured."""
    return 0.5 * wp.exp(-lighting.concentration * (1.0 - cosine))


def make_lit_by(lamp_power: wp.Function) -> wp.Function:
    """Return the function of what one light adds, for a law of its power. A branch would round otherwise."""

    @wp.func
    def lit_by(
        lamp: wp.vec3,
        hit: Hit,
        relief: wp.vec3,
        film: wp.vec3,
        direction: wp.vec3,
        axis: wp.vec3,
        color: wp.vec3,
        gloss: float,
        alpha_sq: float,
        lighting: Lighting,
    ) -> wp.vec3:
        """Return the radiance to the camera from one light: wrapped diffuse reflection and the film's highlight."""
        incoming = lamp - hit.position
        distance_sq = wp.length_sq(incoming)
        incoming = incoming / wp.sqrt(distance_sq)
        power = lamp_power(-wp.dot(incoming, axis), lighting)
        power = power / wp.max(distance_sq, lighting.min_distance_sq)
        falling = wp.dot(relief, incoming)
        diffuse = wp.vec3(
            wp.max((falling + lighting.wrap[0]) / (1.0 + lighting.wrap[0]), 0.0),
            wp.max((falling + lighting.wrap[1]) / (1.0 + lighting.wrap[1]), 0.0),
            wp.max((falling + lighting.wrap[2]) / (1.0 + lighting.wrap[2]), 0.0),
        )
        mirror = wp.max(wp.dot(film, wp.normalize(incoming - direction)), 0.0)
        glint = gloss * highlight(mirror, alpha_sq)
        return (wp.cw_mul(color, diffuse) + wp.vec3(glint, glint, glint)) * power

    return lit_by


lit_by = make_lit_by(beam_power)


@wp.func
def covered_radiance(lighting: Lighting, albedo: wp.Texture2D) -> wp.vec3:
    """Return the radiance of mucosa pressed against the lens: mean color, lit from the least distance ("red-out")."""
    color = mucosa_color(wp.texture_sample(albedo, wp.vec2(0.5, 0.5), dtype=wp.vec4f, lod=16.0), 0.0)
    return wp.cw_mul(color, color) / lighting.min_distance_sq


def make_shade(lit_by: wp.Function) -> wp.Function:
    """Return the function of the radiance from a hit, for what one light adds."""

    @wp.func
    def shade(
        surface: SurfaceView,
        lighting: Lighting,
        world: int,
        hit: Hit,
        camera: wp.transform,
        direction: wp.vec3,
        distance: float,
        texture_offset: wp.vec2,
    ) -> wp.vec3:
        """Return the radiance that a hit sends back along the ray."""
        p = surface.patient[world]
        uv = hit.uv + texture_offset
        texel = wp.texture_sample(surface.albedo[p], uv, dtype=wp.vec4f, lod=hit.level)
        relief_texel = wp.texture_sample(surface.detail[p], uv, dtype=wp.vec4f, lod=hit.level + 1.0)
        color = mucosa_color(texel, hit.tint)
        slope = wp.vec2(2.0 * relief_texel[0] - 1.0, 2.0 * relief_texel[1] - 1.0)
        relief = relief_normal(hit, slope, surface.texture_size[p], lighting.bump)
        film = wp.normalize(hit.normal + (relief - hit.normal) * lighting.film)
        open_sky = wp.clamp(1.0 + 0.85 * hit.tint, 0.15, 1.0)
        gloss = lighting.gloss * (0.25 + 0.75 * relief_texel[3]) * open_sky
        alpha_sq = lighting.roughness_sq + 0.25 * lighting.pixel_angle * lighting.pixel_angle

        axis = wp.transform_vector(camera, wp.vec3(0.0, 0.0, -1.0))
        left = wp.transform_point(camera, lighting.left)
        right = wp.transform_point(camera, lighting.right)
        radiance = lit_by(left, hit, relief, film, direction, axis, color, gloss, alpha_sq, lighting)
        radiance += lit_by(right, hit, relief, film, direction, axis, color, gloss, alpha_sq, lighting)
        bounce = lighting.scatter / wp.max(distance * distance, lighting.min_distance_sq)
        return (radiance + wp.cw_mul(color, color) * bounce) * open_sky

    return shade


shade = make_shade(lit_by)
shade_measured = make_shade(make_lit_by(measured_power))
