# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels of the endoscope camera: rays to radiance and depth, exposure, and the response curve.

Launch dimensions: N worlds, H rows, W columns, S samples a pixel.
"""

import warp as wp

from arcgym.sensors.shading_kernels import (
    Lighting,
    SurfaceView,
    covered_radiance,
    nearest_hit,
    shade,
    shade_measured,
    surface_hit,
)
from arcgym.utils import warp_setup  # noqa: F401

TILE = wp.constant(4)
"""Width and height of the squares of pixels that are drawn together [px]."""
PROBES = wp.constant(14)
"""Directions in which a lens looks for the side of the wall that it is on."""


@wp.func
def probe_direction(probe: int) -> wp.vec3:
    """Return the direction of one of the 14 probes: the six faces and the eight corners of a cube."""
    if probe < 6:
        direction = wp.vec3(0.0)
        direction[probe % 3] = 1.0 - 2.0 * float(probe // 3)
        return direction
    corner = probe - 6
    x = 1.0 - 2.0 * float(corner & 1)
    y = 1.0 - float(corner & 2)
    z = 1.0 - 0.5 * float(corner & 4)
    return wp.normalize(wp.vec3(x, y, z))


@wp.kernel
def look_around(
    surface: SurfaceView,
    drawn: wp.array[wp.bool],
    poses: wp.array[wp.transform],
    far: float,
    sides: wp.array2d[int],
):
    """Find the side of the wall that each probe meets. Launch (N, PROBES).

    Args:
        surface: Surface of all worlds.
        drawn: Worlds to look at, shape (N,).
        poses: Camera poses, shape (N,).
        far: Farthest distance seen [m].
        sides: 1 where a probe meets the wall's front, -1 for its back, 0 for nothing, shape (N, PROBES); written.
    """
    world, probe = wp.tid()
    if not drawn[world]:
        return
    origin = wp.transform_get_translation(poses[world])
    direction = wp.transform_vector(poses[world], probe_direction(probe))
    query = wp.mesh_query_ray(surface.mesh, origin, direction, far, surface.roots[world])
    side = wp.int32(0)
    if query.result:
        side = wp.where(query.sign > 0.0, 1, -1)
    sides[world, probe] = side


@wp.kernel
def find_covered(sides: wp.array2d[int], drawn: wp.array[wp.bool], covered: wp.array[wp.bool]):
    """Mark the worlds whose lens has sunk into the wall: most probes meet the wall's back. Launch (N,).

    Args:
        sides: Side of the wall that each probe meets, shape (N, PROBES).
        drawn: Worlds to look at, shape (N,).
        covered: Whether the lens is covered, shape (N,); written.
    """
    world = wp.tid()
    if not drawn[world]:
        return
    balance = wp.int32(0)
    for probe in range(sides.shape[1]):
        balance += sides[world, probe]
    covered[world] = balance < 0


@wp.kernel(launch_bounds=(256, 4))
def cast_rays(
    surface: SurfaceView,
    drawn: wp.array[wp.bool],
    poses: wp.array[wp.transform],
    rays: wp.array3d[wp.vec3],
    covered: wp.array[wp.bool],
    far: float,
    faces: wp.array4d[int],
    places: wp.array4d[wp.vec3],
):
    """Find the triangle that every ray meets. Launch (N, ceil(H / TILE), ceil(W / TILE), TILE * TILE).

    The threads of a GPU's warp have rays beside and below each other, which go through much the same boxes.

    Args:
        surface: Surface of all worlds.
        drawn: Worlds to draw, shape (N,).
        poses: Camera poses, shape (N,).
        rays: Directions in the camera's frame, shape (H, W, S).
        covered: Worlds whose lens is covered, which have no rays, shape (N,).
        far: Farthest distance seen [m].
        faces: Triangle, -1 for none, shape (N, H, W, S); written.
        places: Distance along the ray [m] and shares of the first two corners, shape (N, H, W, S); written.
    """
    world, tile_row, tile_column, number = wp.tid()
    row = tile_row * TILE + number // TILE
    column = tile_column * TILE + number % TILE
    if row >= rays.shape[0] or column >= rays.shape[1] or not drawn[world] or covered[world]:
        return
    origin = wp.transform_get_translation(poses[world])
    for sample in range(rays.shape[2]):
        direction = wp.transform_vector(poses[world], rays[row, column, sample])
        hit = nearest_hit(surface, world, origin, direction, far)
        faces[world, row, column, sample] = hit.face
        places[world, row, column, sample] = wp.vec3(hit.t, hit.u, hit.v)


def make_light(shade: wp.Function) -> wp.Kernel:
    """Return the kernel that lights what the rays met, for a function of the radiance from a hit."""

    @wp.kernel(launch_bounds=(256, 3))
    def light(
        surface: SurfaceView,
        lighting: Lighting,
        drawn: wp.array[wp.bool],
        poses: wp.array[wp.transform],
        rays: wp.array3d[wp.vec3],
        texture_offset: wp.array[wp.vec2],
        covered: wp.array[wp.bool],
        near: float,
        far: float,
        faces: wp.array4d[int],
        places: wp.array4d[wp.vec3],
        radiance: wp.array3d[wp.vec3],
        depth: wp.array3d[float],
    ):
        """Find radiance (mean of the samples) and distance (nearest of the samples) of every pixel. Launch (N, H, W).

        Args:
            surface: Surface of all worlds.
            lighting: Lights and mucosa.
            drawn: Worlds to draw, shape (N,).
            poses: Camera poses, shape (N,).
            rays: Directions in the camera's frame, shape (H, W, S).
            texture_offset: Shift of the texture in fractions of its size, shape (N,).
            covered: Worlds whose lens is covered, shape (N,).
            near: Distance given where the lens is covered [m].
            far: Farthest distance seen [m].
            faces: Triangle that each ray meets, -1 for none, shape (N, H, W, S).
            places: Distance along the ray [m] and shares of the first two corners, shape (N, H, W, S).
            radiance: Linear radiance, shape (N, H, W); written.
            depth: Distance along the ray [m], shape (N, H, W); written.
        """
        world, row, column = wp.tid()
        if not drawn[world]:
            return
        if covered[world]:
            radiance[world, row, column] = covered_radiance(lighting, surface.albedo[surface.patient[world]])
            depth[world, row, column] = near
            return
        camera = poses[world]
        origin = wp.transform_get_translation(camera)
        total = wp.vec3(0.0)
        nearest = far
        for sample in range(rays.shape[2]):
            direction = wp.transform_vector(camera, rays[row, column, sample])
            face = faces[world, row, column, sample]
            if face >= 0:
                place = places[world, row, column, sample]
                hit = surface_hit(surface, face, place, world, origin, direction, lighting.pixel_angle)
                total += shade(surface, lighting, world, hit, camera, direction, place[0], texture_offset[world])
                nearest = wp.min(nearest, place[0])
        radiance[world, row, column] = total / float(rays.shape[2])
        depth[world, row, column] = nearest

    return light


light = make_light(shade)
light_measured = make_light(shade_measured)


@wp.kernel
def row_brightness(radiance: wp.array3d[wp.vec3], drawn: wp.array[wp.bool], brightness: wp.array2d[float]):
    """Sum up the square root of luminance (Rec. 709) over each row, in a fixed order. Launch (N, H).

    Args:
        radiance: Linear radiance, shape (N, H, W).
        drawn: Worlds to draw, shape (N,).
        brightness: Sum of each row, shape (N, H); written.
    """
    world, row = wp.tid()
    if not drawn[world]:
        return
    total = wp.float32(0.0)
    for column in range(radiance.shape[2]):
        total += wp.sqrt(wp.dot(radiance[world, row, column], wp.vec3(0.2126, 0.7152, 0.0722)))
    brightness[world, row] = total


@wp.kernel
def expose(
    brightness: wp.array2d[float],
    pixels: float,
    target: float,
    gain_min: float,
    gain_max: float,
    lag: float,
    drawn: wp.array[wp.bool],
    poses: wp.array[wp.transform],
    gain: wp.array[float],
    drawn_from: wp.array[wp.transform],
):
    """Find the gain that brings the mean brightness to ``target``. Launch (N,).

    Args:
        brightness: Sum of each row, shape (N, H).
        pixels: Pixels of a picture.
        target: Mean square root of luminance aimed at.
        gain_min: Least gain.
        gain_max: Largest gain.
        lag: Share of the last picture's gain, in the logarithm.
        drawn: Worlds to draw, shape (N,).
        poses: Camera poses, shape (N,).
        gain: Gain of the last picture, 0 where it does not count, shape (N,); updated.
        drawn_from: Camera poses of the picture, shape (N,); written.
    """
    world = wp.tid()
    if not drawn[world]:
        return
    drawn_from[world] = poses[world]
    total = wp.float32(0.0)
    for row in range(brightness.shape[1]):
        total += brightness[world, row]
    mean = total / pixels
    wanted = wp.clamp(target / (mean * mean + 1.0e-9), gain_min, gain_max)
    last = gain[world]
    if lag > 0.0 and last > 0.0:
        wanted = wp.exp(lag * wp.log(last) + (1.0 - lag) * wp.log(wanted))
    gain[world] = wanted


@wp.func
def square_root(light: float, gamma: float) -> float:
    """Return the brightness of a light for gamma 2."""
    return wp.sqrt(light)


@wp.func
def any_root(light: float, gamma: float) -> float:
    """Return the brightness of a light for any gamma."""
    return wp.pow(light, 1.0 / gamma)


def make_develop(root: wp.Function) -> wp.Kernel:
    """Return the kernel that makes bytes of radiance, for a function of the brightness of a light."""

    @wp.func
    def response(radiance: float, edge: float, contrast: float, gamma: float) -> wp.uint8:
        """Return the camera response as a byte: saturating, gamma, then an S-curve."""
        level = root(1.0 - wp.exp(-radiance), gamma) * edge
        curve = level * level * (3.0 - 2.0 * level)
        return wp.uint8(255.0 * (level + contrast * (curve - level)) + 0.5)

    @wp.kernel
    def develop(
        radiance: wp.array3d[wp.vec3],
        gain: wp.array[float],
        light_gain: wp.array[float],
        color_gain: wp.array[wp.vec3],
        rays: wp.array3d[wp.vec3],
        vignette: float,
        contrast: float,
        gamma: float,
        drawn: wp.array[wp.bool],
        rgb: wp.array4d[wp.uint8],
    ):
        """Convert exposed radiance to bytes. Launch (N, H, W).

        Args:
            radiance: Linear radiance, shape (N, H, W).
            gain: Gain of the exposure, shape (N,).
            light_gain: Brightness relative to it, shape (N,).
            color_gain: Gain of red, green and blue, shape (N,).
            rays: Directions in the camera's frame, shape (H, W, S).
            vignette: Darkening towards the rim, 0 to 1.
            contrast: Strength of the S-curve, 0 to 1.
            gamma: Root by which light becomes brightness.
            drawn: Worlds to draw, shape (N,).
            rgb: Picture, shape (N, H, W, 3); written.
        """
        world, row, column = wp.tid()
        if not drawn[world]:
            return
        exposed = wp.cw_mul(radiance[world, row, column], color_gain[world]) * (gain[world] * light_gain[world])
        cosine = wp.max(-rays[row, column, 0][2], 0.0)
        edge = 1.0 - vignette * (1.0 - cosine)
        rgb[world, row, column, 0] = response(exposed[0], edge, contrast, gamma)
        rgb[world, row, column, 1] = response(exposed[1], edge, contrast, gamma)
        rgb[world, row, column, 2] = response(exposed[2], edge, contrast, gamma)

    return develop


develop = make_develop(square_root)
develop_gamma = make_develop(any_root)
