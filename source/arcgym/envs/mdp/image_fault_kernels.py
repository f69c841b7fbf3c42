# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels of what spoils a picture; :mod:`arcgym.envs.mdp.image_faults` says what each is. Launch (N, H, W).

N worlds, pictures of H x W pixels: ``image`` and ``out``, uint8, shape (N, H, W, 3); ``depth``, distance along the
ray [m], shape (N, H, W). Every pixel depends on its own world alone.
"""

import warp as wp

from arcgym.sensors.blob_kernels import blob_at
from arcgym.utils import warp_setup  # noqa: F401


@wp.func
def pixel(image: wp.array4d[wp.uint8], world: int, row: int, column: int) -> wp.vec3:
    """Return a pixel's color, 0 to 255; beyond the edge, that of the edge."""
    r = wp.clamp(row, 0, image.shape[1] - 1)
    c = wp.clamp(column, 0, image.shape[2] - 1)
    return wp.vec3(float(image[world, r, c, 0]), float(image[world, r, c, 1]), float(image[world, r, c, 2]))


@wp.func
def put(out: wp.array4d[wp.uint8], world: int, row: int, column: int, color: wp.vec3):
    """Write a color, rounded and clamped to a byte."""
    for k in range(3):
        out[world, row, column, k] = wp.uint8(wp.clamp(color[k] + 0.5, 0.0, 255.0))


@wp.kernel
def turbid_fluid(
    image: wp.array4d[wp.uint8], depth: wp.array3d[float], extinction: float, murk: wp.vec3, out: wp.array4d[wp.uint8]
):
    """Fade to the fluid's color with the distance, by Beer and Lambert; ``extinction`` [1/m]."""
    world, row, column = wp.tid()
    clear = wp.exp(-extinction * depth[world, row, column])
    put(out, world, row, column, clear * pixel(image, world, row, column) + (1.0 - clear) * murk)


@wp.func
def place_of(
    poses: wp.array[wp.transform], rays: wp.array3d[wp.vec3], world: int, row: int, column: int, away: float
) -> wp.vec3:
    """Return the place in space that a pixel shows [m]."""
    return wp.transform_point(poses[world], away * rays[row, column, 0])


@wp.kernel
def stool(
    image: wp.array4d[wp.uint8],
    depth: wp.array3d[float],
    poses: wp.array[wp.transform],
    rays: wp.array3d[wp.vec3],
    seed: wp.array[int],
    share: float,
    out: wp.array4d[wp.uint8],
):
    """Cover the wall with dull brown lumps, in a ``share`` of the cells of 2 cm."""
    world, row, column = wp.tid()
    color = pixel(image, world, row, column)
    place = place_of(poses, rays, world, row, column, depth[world, row, column])
    blob = blob_at(place, 0.02, share, 0.25, 0.6, seed[world])
    if blob[0] > 0.0:
        light = (0.299 * color[0] + 0.587 * color[1] + 0.114 * color[2]) / 130.0
        brown = wp.vec3(120.0, 85.0, 40.0) * (0.7 + 0.6 * blob[1]) * light
        edge = wp.min(blob[0] / 0.15, 1.0)
        color = (1.0 - edge) * color + edge * brown
    put(out, world, row, column, color)


@wp.kernel
def bubbles(
    image: wp.array4d[wp.uint8],
    depth: wp.array3d[float],
    poses: wp.array[wp.transform],
    rays: wp.array3d[wp.vec3],
    seed: wp.array[int],
    share: float,
    out: wp.array4d[wp.uint8],
):
    """Lay foam on the wall: bright rims with a glint, in a ``share`` of the cells of 6 mm."""
    world, row, column = wp.tid()
    color = pixel(image, world, row, column)
    place = place_of(poses, rays, world, row, column, depth[world, row, column])
    blob = blob_at(place, 0.006, share, 0.3, 0.6, seed[world])
    if blob[0] > 0.0:
        white = wp.vec3(235.0, 225.0, 205.0)
        rim = wp.exp(-wp.pow((blob[0] - 0.1) / 0.12, 2.0))
        glint = wp.exp(-wp.pow((blob[0] - 0.6) / 0.08, 2.0)) * wp.where(blob[1] > 0.6, 1.0, 0.2)
        veil = wp.min(0.15 + 0.6 * rim + 0.5 * glint, 0.95)
        color = (1.0 - veil) * color + veil * white
    put(out, world, row, column, color)


@wp.kernel
def droplets(image: wp.array4d[wp.uint8], seed: wp.array[int], count: int, out: wp.array4d[wp.uint8]):
    """Show the picture turned about and shrunk in ``count`` drops on the lens, as a drop's refraction does."""
    world, row, column = wp.tid()
    size = float(image.shape[2])
    x = float(column)
    y = float(row)
    color = pixel(image, world, row, column)
    state = wp.rand_init(seed[world])
    for _drop in range(count):
        cx = size * wp.randf(state)
        cy = float(image.shape[1]) * wp.randf(state)
        radius = size * (0.04 + 0.07 * wp.randf(state))
        away = wp.sqrt((x - cx) * (x - cx) + (y - cy) * (y - cy)) / radius
        if away < 1.0:
            sx = int(cx - 3.0 * (x - cx) + 0.5)
            sy = int(cy - 3.0 * (y - cy) + 0.5)
            color = (1.0 - 0.5 * wp.pow(away, 6.0)) * pixel(image, world, sy, sx)
    put(out, world, row, column, color)


@wp.kernel
def blur_rows(image: wp.array4d[wp.uint8], deviation: float, out: wp.array3d[wp.vec3]):
    """Average along the rows with Gaussian weights; ``deviation`` [px]."""
    world, row, column = wp.tid()
    total = wp.vec3(0.0)
    weights = wp.float32(0.0)
    reach = int(wp.ceil(3.0 * deviation))
    for k in range(-reach, reach + 1):
        weight = wp.exp(-0.5 * float(k * k) / (deviation * deviation))
        total += weight * pixel(image, world, row, column + k)
        weights += weight
    out[world, row, column] = total / weights


@wp.kernel
def blur_columns(image: wp.array3d[wp.vec3], deviation: float, out: wp.array4d[wp.uint8]):
    """Average what :func:`blur_rows` left along the columns."""
    world, row, column = wp.tid()
    total = wp.vec3(0.0)
    weights = wp.float32(0.0)
    reach = int(wp.ceil(3.0 * deviation))
    for k in range(-reach, reach + 1):
        weight = wp.exp(-0.5 * float(k * k) / (deviation * deviation))
        total += weight * image[world, wp.clamp(row + k, 0, image.shape[1] - 1), column]
        weights += weight
    put(out, world, row, column, total / weights)


@wp.kernel
def sensor_noise(
    image: wp.array4d[wp.uint8],
    seed: wp.array[int],
    step: wp.array[wp.int64],
    deviation: float,
    out: wp.array4d[wp.uint8],
):
    """Add normally distributed noise to every value; ``deviation`` of 255."""
    world, row, column = wp.tid()
    state = wp.rand_init(seed[world], int(step[world]))
    state = wp.rand_init(int(state), row * image.shape[2] + column)
    color = pixel(image, world, row, column)
    noise = wp.vec3(wp.randn(state), wp.randn(state), wp.randn(state))
    put(out, world, row, column, color + deviation * noise)
