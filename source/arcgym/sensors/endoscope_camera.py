# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The camera at the tip of the endoscope, in every world."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import torch
import warp as wp

from arcgym.sensors.camera_view import CameraView
from arcgym.sensors.mucosa_textures import MucosaTextures, load_textures, read_images
from arcgym.sensors.preparation import Preparation
from arcgym.sensors.sensor_base import SensorBase
from arcgym.sensors.skinned_surface import SkinnedSurface
from arcgym.sensors.surface_renderer import Optics, SurfaceRenderer, WorldLooks
from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.configclass import validate
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.anatomy.stage import VisualMesh
    from arcgym.assets.endoscope_spec import CameraSpec
    from arcgym.assets.patient import Patient
    from arcgym.scene.interactive_scene import InteractiveScene
    from arcgym.sensors.endoscope_camera_cfg import EndoscopeCameraCfg


@dataclass
class EndoscopeCameraData:
    """Last picture of every world; the tensors are views of the renderer's memory and change with every update."""

    pos_w: torch.Tensor
    """Position of the camera when the picture was taken [m], shape (N, 3)."""
    quat_w_opengl: torch.Tensor
    """Orientation (x, y, z, w) of the frame that looks along −Z with +Y up, shape (N, 4)."""
    covered: torch.Tensor
    """Whether the lens has sunk into the wall, shape (N,), bool. The picture is then an even red and the depth the
    camera's near clipping distance: an unlit void behind the wall would look like open lumen."""
    output: dict[str, torch.Tensor] = field(default_factory=dict)
    """``rgb``: uint8, shape (N, H, W, 3). ``depth``: distance along the ray [m], float32, shape (N, H, W)."""
    frame: int = 0
    """How often some world was drawn so far: what is computed from the output holds until it changes."""


class EndoscopeCamera(SensorBase):
    """Batched ray-cast camera inside the deforming colon.

    One update skins the visual surface to the wall, refits its ray tree and draws every world: launches only, no
    transfer to the host, so that it can be captured in a graph.
    """

    cfg: EndoscopeCameraCfg

    def __init__(self, cfg: EndoscopeCameraCfg) -> None:
        """Check the configuration."""
        super().__init__(cfg)
        validate(cfg, "camera")

    def initialize(self, scene: InteractiveScene) -> None:
        """Bind the camera to ``scene["colon"]`` and ``scene["endoscope"]`` and allocates its buffers."""
        self._colon, self._endoscope = scene["colon"], scene["endoscope"]
        self._device = str(scene.device)
        patients = self._colon.patients
        self._looks = WorldLooks.neutral(scene.num_envs, self._device)
        self._drawn = wp.full(scene.num_envs, True, dtype=wp.bool, device=self._device)
        visuals, walls = [patient.visual for patient in patients], [patient.wall for patient in patients]
        surface = SkinnedSurface(visuals, walls, scene.num_envs, self._device, self._colon.patient_wp)
        images = [(patient.albedo_texture, patient.detail_texture) for patient in patients]
        textures = load_textures(images, self._device)
        size = (self.cfg.width, self.cfg.height)
        self._visuals = visuals
        self._renderer = SurfaceRenderer(surface, visuals, textures, self._optics(), size, self.cfg.samples)
        self._skinned: int | None = None
        """Version of the wall, see :attr:`Colon.wall_version`, that the surface of all worlds shows."""
        self._fine_patient: Patient | None = None
        self._snapshots: dict[tuple[int, int], SurfaceRenderer] = {}
        self._view: CameraView | None = None
        if self.cfg.latency > 0.0 or self.cfg.exposure.shutter is not None:
            self._view = CameraView(scene, self.cfg.latency)
        self._stepped = False
        self._preparation: Preparation | None = None
        if self.cfg.preparation.scores is not None:
            self._preparation = Preparation(self.cfg.preparation, scene)
            self._preparation.cover(self._renderer, patients, visuals)
        self._data = self._make_data()

    @property
    def data(self) -> EndoscopeCameraData:
        """Last picture of every world."""
        return self._data

    @property
    def surface(self) -> SkinnedSurface:
        """The surface that the policy's camera sees, also for other views of the scene."""
        return self._renderer.surface

    @property
    def renderer(self) -> SurfaceRenderer:
        """Rays, surface and buffers of the policy's pictures."""
        return self._renderer

    @property
    def radiance(self) -> torch.Tensor:
        """Linear radiance before exposure, in arbitrary units, shape (N, H, W, 3)."""
        return wp.to_torch(self._renderer.radiance)

    @property
    def exposure_gain(self) -> torch.Tensor:
        """Gain of the last picture, shape (N,); 0 in worlds that were reset since."""
        return wp.to_torch(self._renderer.gain)

    @property
    def field_of_view(self) -> float:
        """Angle from corner to corner [rad]."""
        spec = self._endoscope.stage.camera
        return spec.field_of_view if self.cfg.field_of_view is None else self.cfg.field_of_view

    def update(self, env_mask: torch.Tensor | None = None) -> None:
        """Draw the worlds of `env_mask`, shape (num_envs,), bool, again; None draws all.

        Pictures of the other worlds stay bit for bit.
        """
        if env_mask is None:
            self._drawn.fill_(True)
        else:
            wp.copy(self._drawn, wp.from_torch(env_mask, dtype=wp.bool))
        if self._view is not None:
            self._view.refresh(self._drawn, self._stepped)
        late = None if self._view is None else self._view.shot.wall
        version = None if late is not None else self._colon.wall_version
        if env_mask is not None or version is None or version != self._skinned:
            self._renderer.surface.update(self._colon.nodal_pos_wp if late is None else late, self._drawn)
            self._skinned = version if env_mask is None else None
        self.draw()

    def advance(self, dt: float) -> None:
        """Let `dt` seconds pass, a control step, and draw all worlds when the update period is over."""
        self._stepped = True
        try:
            super().advance(dt)
        finally:
            self._stepped = False

    def draw(self) -> None:
        """Draw the worlds of the last update again from the camera poses, without moving the wall."""
        motion = None if self._view is None else self._view.shot.motion
        self._renderer.draw(self.poses_wp, self._looks, self._drawn, motion)
        self._data.frame += 1

    @property
    def poses_wp(self) -> wp.array:
        """Camera poses that the next picture is drawn from, shape (N,), transform: late by the latency."""
        return self._endoscope.camera_pose_wp if self._view is None else self._view.shot.pose

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Let the exposure of the worlds start anew with their next picture."""
        fill_worlds(wp.to_torch(self._renderer.gain), env_ids, 0.0)

    def world_settings(self) -> dict[str, torch.Tensor]:
        """Return the looks of all worlds: ``light_gain`` (N,), ``color_gain`` (N, 3), ``texture_offset`` (N, 2); with a
        preparation its ``scores`` (N, 3) and ``seed`` (N,) too."""
        names = ("light_gain", "color_gain", "texture_offset")
        looks = {name: wp.to_torch(getattr(self._looks, name)) for name in names}
        return looks | ({} if self._preparation is None else self._preparation.settings)

    def memory(self) -> dict[str, torch.Tensor]:
        """Return the last pictures, where they were taken, and the gain that the next exposure starts from."""
        names = ("rgb", "depth", "radiance", "covered", "gain", "drawn_from")
        arrays = {name: wp.to_torch(getattr(self._renderer, name)) for name in names}
        return arrays | ({} if self._view is None else self._view.memory)

    def write_light_gain(self, gain: torch.Tensor, env_ids: torch.Tensor | None = None) -> None:
        """Set the brightness of the picture relative to the exposure's aim, shape (n,); 1 is neutral."""
        wp.to_torch(self._looks.light_gain)[slice(None) if env_ids is None else env_ids] = gain

    def write_color_gain(self, gain: torch.Tensor, env_ids: torch.Tensor | None = None) -> None:
        """Set the gain of red, green and blue, shape (n, 3); ones are neutral."""
        wp.to_torch(self._looks.color_gain)[slice(None) if env_ids is None else env_ids] = gain

    def write_texture_offset(self, offset: torch.Tensor, env_ids: torch.Tensor | None = None) -> None:
        """Shift the mucosa texture by fractions of its size along u and v, shape (n, 2)."""
        wp.to_torch(self._looks.texture_offset)[slice(None) if env_ids is None else env_ids] = offset

    def write_preparation(self, scores: torch.Tensor, seed: torch.Tensor, env_ids: torch.Tensor | None = None) -> None:
        """Set how clean the colon is and where what is left lies.

        Args:
            scores: Boston bowel preparation scores, 0 to 3, of right, transverse and left colon, shape (n, 3).
            seed: Number that places stool, shape (n,).
            env_ids: The worlds; all by default.

        Raises:
            ValueError: If the camera shows no stool and fluid.
        """
        if self._preparation is None:
            raise ValueError("The camera shows no stool and fluid: set env.scene.camera.preparation.scores=[2,3,3].")
        self._preparation.write(scores, seed, env_ids)

    def another_renderer(self, size: tuple[int, int], samples: int = 1) -> SurfaceRenderer:
        """Return a renderer of the same surface for pictures of another size (width, height) [px]."""
        textures, optics = self._renderer.textures, self._optics()
        renderer = SurfaceRenderer(self.surface, self._visuals, textures, optics, size, samples)
        if self._preparation is not None:
            self._preparation.cover(renderer, self._colon.patients, self._visuals)
        return renderer

    @property
    def looks(self) -> WorldLooks:
        """What events made different between the worlds' pictures."""
        return self._looks

    def snapshot_view(self, env_id: int = 0, size: int = 512, samples: int = 2) -> tuple[np.ndarray, np.ndarray]:
        """Draw one world large, from the fine surface, for people to look at.

        The fine surface is made at the first call and kept until a world with another patient is drawn. Exposure has no
        lag here, and the picture is sharp and of the present whatever the camera's latency.

        Args:
            env_id: World to draw, as it is now.
            size: Width and height [px].
            samples: Rays per pixel.

        Returns:
            Color, uint8, shape (size, size, 3), and distance along the ray [m], float32, shape (size, size).
        """
        self._show(env_id)
        renderer = self._snapshot_renderer(size, samples, env_id)
        renderer.gain.zero_()
        renderer.surface.update(self._colon.nodal_pos_wp[:, env_id : env_id + 1])
        pose = self._endoscope.camera_pose_wp[env_id : env_id + 1]
        drawn = wp.full(1, True, dtype=wp.bool, device=self._device)
        renderer.draw(pose, self._looks.of_world(env_id), drawn)
        return renderer.rgb.numpy()[0].copy(), renderer.depth.numpy()[0].copy()

    def still_renderer(self, env_id: int, size: int, samples: int = 1) -> SurfaceRenderer:
        """Return a renderer of its own of the fine surface of a world's patient, for pictures of copied states."""
        visual, surface, textures = self._fine_surface(self._colon.patient_of(env_id))
        return SurfaceRenderer(surface, [visual], [textures], self._optics(), (size, size), samples)

    def _show(self, env_id: int) -> None:
        """Make the fine surface of a world's patient if it is not there."""
        patient = self._colon.patient_of(env_id)
        if patient is not self._fine_patient:
            self._fine_patient, self._fine = patient, self._fine_surface(patient)
            self._snapshots.clear()

    def _snapshot_renderer(self, size: int, samples: int, env_id: int) -> SurfaceRenderer:
        """Return the renderer of one world's fine surface at this size, making it at first use."""
        key = (size, samples)
        if key not in self._snapshots:
            visual, surface, textures = self._fine
            self._snapshots[key] = SurfaceRenderer(surface, [visual], [textures], self._optics(), (size, size), samples)
        if self._preparation is not None:
            patients = [self._colon.patient_of(env_id)]
            self._preparation.cover(self._snapshots[key], patients, [self._fine[0]], env_id)
        return self._snapshots[key]

    def _fine_surface(self, patient: Patient) -> tuple[VisualMesh, SkinnedSurface, MucosaTextures]:
        """Return the fine visual mesh of one world with its textures."""
        visual = patient.stage.visual
        surface = SkinnedSurface(visual, patient.wall, 1, self._device)
        images = read_images(patient.albedo_texture, patient.detail_texture)
        return visual, surface, MucosaTextures(*images, self._device, smooth_levels=True)

    def _optics(self) -> Optics:
        """Gather what the endoscope's stage and the configuration say about camera and lights."""
        stage = self._endoscope.stage
        lamp = self.cfg.lighting.lamp
        lights = lights_in_camera(stage.lights, stage.camera) if lamp is None else np.array([lamp, lamp])
        near = float(stage.camera.clipping[0])
        return Optics(self.field_of_view, lights, near, self.cfg.far, self.cfg.lighting, self.cfg.exposure)

    def _make_data(self) -> EndoscopeCameraData:
        """Show the renderer's buffers as tensors."""
        pose = wp.to_torch(self._renderer.drawn_from)
        outputs = {"rgb": self._renderer.rgb, "depth": self._renderer.depth}
        views = {name: wp.to_torch(outputs[name]) for name in self.cfg.data_types}
        return EndoscopeCameraData(pose[:, :3], pose[:, 3:], wp.to_torch(self._renderer.covered), views)


def lights_in_camera(lights: np.ndarray, camera: CameraSpec) -> np.ndarray:
    """Return light positions, given like the camera in the last link's frame, in the camera's frame [m], (2, 3)."""
    x, y, z, w = (float(c) for c in camera.quaternion)
    axis, offset = np.array([-x, -y, -z]), np.asarray(lights, dtype=np.float64) - np.asarray(camera.position)
    twice = 2.0 * np.cross(axis, offset)
    return offset + w * twice + np.cross(axis, twice)
