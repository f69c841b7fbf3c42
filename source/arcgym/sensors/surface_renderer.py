# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the skinned surface from one camera per world: the launches behind both cameras."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import warp as wp

from arcgym.anatomy.stage.types import TEXTURE_LENGTH
from arcgym.sensors.camera_kernels import (
    PROBES,
    TILE,
    cast_rays,
    develop,
    develop_gamma,
    expose,
    find_covered,
    light,
    light_measured,
    look_around,
    row_brightness,
)
from arcgym.sensors.camera_rays import fisheye_rays, pixel_angle
from arcgym.sensors.motion_kernels import smear
from arcgym.sensors.shading_kernels import Lighting, SurfaceView
from arcgym.sensors.texture_density import texel_density
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.cpu_threads import Pace, share_out

if TYPE_CHECKING:
    from arcgym.anatomy.stage import VisualMesh
    from arcgym.sensors.lighting_cfg import ExposureCfg, LightingCfg
    from arcgym.sensors.mucosa_textures import MucosaTextures
    from arcgym.sensors.skinned_surface import SkinnedSurface


GAMMA = 2.0
"""Gamma of the plain kernel."""


@dataclass(frozen=True)
class Optics:
    """Camera and lights of one endoscope."""

    field_of_view: float
    """Angle from corner to corner [rad]."""
    lights: np.ndarray
    """Positions of the two lights in the camera's frame [m], shape (2, 3)."""
    near: float
    """Distance given where the lens is covered by the wall [m]."""
    far: float
    """Farthest distance seen [m]."""
    lighting: LightingCfg
    """Tip lights and wet mucosa."""
    exposure: ExposureCfg
    """Automatic exposure and response curve."""


@dataclass(frozen=True)
class WorldLooks:
    """Values that differ between worlds."""

    light_gain: wp.array
    """Brightness relative to the exposure's aim, shape (num_envs,), float."""
    color_gain: wp.array
    """Gain of red, green and blue, shape (num_envs,), vec3."""
    texture_offset: wp.array
    """Where the texture starts, in fractions of its size, shape (num_envs,), vec2."""

    @classmethod
    def neutral(cls, num_envs: int, device: str) -> WorldLooks:
        """Return the same plain look for every world."""
        return cls(
            wp.full(num_envs, 1.0, dtype=float, device=device),
            wp.full(num_envs, wp.vec3(1.0), dtype=wp.vec3, device=device),
            wp.zeros(num_envs, dtype=wp.vec2, device=device),
        )

    def of_world(self, env_id: int) -> WorldLooks:
        """Return the look of one world, sharing memory."""
        one = slice(env_id, env_id + 1)
        return WorldLooks(self.light_gain[one], self.color_gain[one], self.texture_offset[one])


class SurfaceRenderer:
    """Rays, buffers and launches for one picture size; :meth:`draw` can be captured in a graph."""

    def __init__(
        self,
        surface: SkinnedSurface,
        visuals: Sequence[VisualMesh],
        textures: Sequence[MucosaTextures],
        optics: Optics,
        size: tuple[int, int],
        samples: int,
    ) -> None:
        """Allocate everything for pictures of `size` (width, height) [px] with `samples` rays per pixel.

        `visuals` and `textures` are those of each patient that `surface` was made of.
        """
        width, height = size
        self.surface, self.textures, self.optics = surface, tuple(textures), optics
        self.shape = (surface.num_envs, height, width)
        device = self.device = surface.device
        rays = fisheye_rays(width, height, optics.field_of_view, samples)
        self.rays = wp.array(rays, dtype=wp.vec3, device=device)
        self.rgb = wp.zeros((*self.shape, 3), dtype=wp.uint8, device=device)
        """Pictures, shape (N, H, W, 3), uint8."""
        self.depth = wp.full(self.shape, optics.far, dtype=float, device=device)
        """Distance along each pixel's ray [m], shape (N, H, W)."""
        self.radiance = wp.zeros(self.shape, dtype=wp.vec3, device=device)
        """Linear radiance before exposure, in arbitrary units, shape (N, H, W), vec3."""
        self._faces = wp.zeros((*self.shape, samples), dtype=int, device=device)
        self._places = wp.zeros((*self.shape, samples), dtype=wp.vec3, device=device)
        self._sides = wp.zeros((surface.num_envs, int(PROBES)), dtype=int, device=device)
        self.covered = wp.zeros(surface.num_envs, dtype=wp.bool, device=device)
        """Worlds whose lens is covered, shape (N,)."""
        self.gain = wp.zeros(surface.num_envs, dtype=float, device=device)
        """Gain of the last picture; 0 in worlds that were reset since, shape (N,)."""
        self.drawn_from = wp.zeros(surface.num_envs, dtype=wp.transform, device=device)
        """Pose of the camera in each world's last picture, shape (N,), transform."""
        self._drawn_before = False
        self._casting, self._developing = Pace(), Pace()
        self._brightness = wp.zeros(self.shape[:2], dtype=float, device=device)
        self.view = _surface_view(surface, visuals, textures)
        self.overlay: Callable[[wp.array], None] | None = None
        """Called with the camera poses once the wall's radiance is there, to put more into it before the exposure."""
        self.soil: Callable[[wp.array, wp.array], None] | None = None
        """Called before that with the camera poses and the worlds drawn, to lay stool and fluid on the wall."""
        self._smeared: wp.array | None = None
        self._pixel_angle = pixel_angle(width, height, optics.field_of_view)
        self.lighting = _lighting(optics, self._pixel_angle / samples**0.5)

    def draw(self, poses: wp.array, looks: WorldLooks, drawn: wp.array, motion: wp.array | None = None) -> None:
        """Draw the worlds marked in `drawn` (num_envs,), bool, from the camera poses (num_envs,), transform.

        `motion` (num_envs,), spatial_vector, is the velocity [m/s] and spin [rad/s] of the camera in its own frame, by
        which a picture with a shutter is blurred; None draws it sharp.
        """
        self._find_covered(poses, drawn)
        self._in_parts(self._casting, lambda rows: self._cast(poses, looks, drawn, rows))
        if self.soil is not None:
            self.soil(poses, drawn)
        if self.overlay is not None:
            self.overlay(poses)
        self._expose(poses, drawn)
        radiance = self.radiance if motion is None else self._smear(motion, drawn)
        self._in_parts(self._developing, lambda rows: self._develop(radiance, looks, drawn, rows))
        self._drawn_before = True

    def _in_parts(self, pace: Pace, work: Callable[[slice], None]) -> None:
        """Do ``work`` on the rows of all pictures: on a CPU on as many parts of them at once as there are threads.

        Not with the first picture, which loads the kernels.
        """
        device, height = wp.get_device(self.device), self.shape[1]
        if device.is_cuda or device.is_capturing or not self._drawn_before:
            work(slice(0, height))
            return

        def draw(threads: int) -> None:
            bounds = [height * k // threads for k in range(threads + 1)]
            parts = [slice(first, end) for first, end in zip(bounds[:-1], bounds[1:], strict=True) if end > first]
            share_out(threads, parts, work)

        pace.run(draw)

    def _find_covered(self, poses: wp.array, drawn: wp.array) -> None:
        """Find the worlds whose lens is covered."""
        wp.launch(
            look_around,
            self._sides.shape,
            inputs=[self.view, drawn, poses, self.optics.far],
            outputs=[self._sides],
            device=self.device,
        )
        wp.launch(find_covered, self.shape[0], inputs=[self._sides, drawn], outputs=[self.covered], device=self.device)

    def _cast(self, poses: wp.array, looks: WorldLooks, drawn: wp.array, rows: slice) -> None:
        """Find what the rays meet, then light it: two kernels, as a GPU has room for more threads that only trace."""
        (num_envs, _, width), height, far = self.shape, rows.stop - rows.start, self.optics.far
        rays, hits = self.rays[rows], [self._faces[:, rows], self._places[:, rows]]
        wp.launch(
            cast_rays,
            (num_envs, -(-height // TILE), -(-width // TILE), TILE * TILE),
            inputs=[self.view, drawn, poses, rays, self.covered, far],
            outputs=hits,
            device=self.device,
        )
        lit_by = [drawn, poses, rays, looks.texture_offset, self.covered, self.optics.near, far]
        wp.launch(
            light if self.optics.lighting.concentration is None else light_measured,
            (num_envs, height, width),
            inputs=[self.view, self.lighting, *lit_by, *hits],
            outputs=[self.radiance[:, rows], self.depth[:, rows]],
            device=self.device,
        )

    def _develop(self, radiance: wp.array, looks: WorldLooks, drawn: wp.array, rows: slice) -> None:
        num_envs, _, width = self.shape
        exposure = self.optics.exposure
        wp.launch(
            develop if exposure.gamma == GAMMA else develop_gamma,
            (num_envs, rows.stop - rows.start, width),
            inputs=[
                radiance[:, rows],
                self.gain,
                looks.light_gain,
                looks.color_gain,
                self.rays[rows],
                exposure.vignette,
                exposure.contrast,
                exposure.gamma,
                drawn,
            ],
            outputs=[self.rgb[:, rows]],
            device=self.device,
        )

    def _smear(self, motion: wp.array, drawn: wp.array) -> wp.array:
        """Return the radiance that the open shutter collects of a picture with a camera that moves."""
        cfg = self.optics.exposure
        if cfg.shutter is None:
            return self.radiance
        if self._smeared is None:
            self._smeared = wp.zeros_like(self.radiance)
        shutter = wp.vec3(*cfg.shutter, cfg.longest_gain)
        seen = [self.radiance, self.depth, self.rays, self.covered]
        inputs = [*seen, motion, self.gain, shutter, 1.0 / self._pixel_angle, drawn]
        wp.launch(smear, self.shape, inputs=inputs, outputs=[self._smeared], device=self.device)
        return self._smeared

    def _expose(self, poses: wp.array, drawn: wp.array) -> None:
        """Find the gain of every world."""
        num_envs, height, width = self.shape
        cfg = self.optics.exposure
        low, high = cfg.gain_range if cfg.automatic else (cfg.gain, cfg.gain)
        wp.launch(
            row_brightness,
            (num_envs, height),
            inputs=[self.radiance, drawn],
            outputs=[self._brightness],
            device=self.device,
        )
        wp.launch(
            expose,
            num_envs,
            inputs=[self._brightness, float(height * width), cfg.target, low, high, cfg.lag, drawn, poses],
            outputs=[self.gain, self.drawn_from],
            device=self.device,
        )


def _surface_view(
    surface: SkinnedSurface, visuals: Sequence[VisualMesh], textures: Sequence[MucosaTextures]
) -> SurfaceView:
    """Pack what the kernel needs of the surface."""
    device = surface.device
    attributes = np.zeros((surface.num_vertices, len(visuals), 4), np.float32)
    for p, (visual, image) in enumerate(zip(visuals, textures, strict=True)):
        density = texel_density(visual, image.width, image.height)
        attributes[: len(visual.points), p] = np.column_stack([visual.uv, visual.tint, density])
    sizes = [(TEXTURE_LENGTH * image.width / image.height, TEXTURE_LENGTH) for image in textures]
    view = SurfaceView()
    view.mesh = surface.mesh.id
    view.roots = surface.roots
    view.normals = surface.normals
    view.patient = surface.patient
    view.attributes = wp.array(attributes, dtype=wp.vec4, device=device)
    view.albedo = wp.array([image.albedo for image in textures], dtype=wp.Texture2D, device=device)
    view.detail = wp.array([image.detail for image in textures], dtype=wp.Texture2D, device=device)
    view.texture_size = wp.array(sizes, dtype=wp.vec2, device=device)
    return view


def _lighting(optics: Optics, angle: float) -> Lighting:
    """Pack the lighting configuration; `angle` is what one sample spans [rad]."""
    cfg, lights = optics.lighting, optics.lights
    lighting = Lighting()
    lighting.left = wp.vec3(*map(float, lights[0]))
    lighting.right = wp.vec3(*map(float, lights[1]))
    lighting.wrap = wp.vec3(*cfg.wrap)
    for name in ("beam", "scatter", "bump", "film", "gloss"):
        setattr(lighting, name, getattr(cfg, name))
    lighting.concentration = cfg.concentration or 0.0
    lighting.roughness_sq = cfg.roughness**2
    lighting.min_distance_sq = cfg.min_distance**2
    lighting.pixel_angle = angle
    return lighting
