# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The picture of `env.render()` and of videos: the endoscope's view beside the outside view."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, ImageDraw

from arcgym.assets.force_tiers import tiers_of
from arcgym.sensors import SkinnedSurface
from arcgym.viewers.drawing import DARK, DIM_INK, font
from arcgym.viewers.frame_info import FrameInfo, read_info
from arcgym.viewers.legend import draw_legends
from arcgym.viewers.outside_view import OutsideView
from arcgym.viewers.overlay import draw_panel, octagon
from arcgym.viewers.palette import shown_tiers
from arcgym.viewers.viewer_cfg import ViewerCfg
from arcgym.viewers.wall_paint import WallPaint, window_at_links

if TYPE_CHECKING:
    from arcgym.assets.patient import Patient
    from arcgym.envs import ManagerBasedEnv

_MARGIN = 8
_PANEL_HEIGHT = 96
_HISTORY = 100


class TwoPaneView:
    """Draws one world of an environment from inside and from outside, with numbers and charts below.

    The outside view is drawn from the coarse visual surface, the endoscope's view from the fine one.

    Attributes:
        rewards: Reward of each frame of the episode so far, newest last.
        forces: Largest wall force on a window of the scope in each frame [N], newest last.
    """

    def __init__(self, env: ManagerBasedEnv, cfg: ViewerCfg | None = None) -> None:
        """Build the surface of the first world.

        Args:
            env: Environment whose scene holds ``colon``, ``endoscope`` and, if it has one, ``camera``.
            cfg: Size, quality and colors; None for the defaults.
        """
        self.cfg = cfg or ViewerCfg()
        self._env = env
        self._tiers = shown_tiers(tiers_of(env.cfg))
        self._colon, self._scope = env.scene["colon"], env.scene["endoscope"]
        self._show(self._colon.patient_of(0))
        self._env_id, self._time = 0, 0.0
        self.rewards: deque[float] = deque(maxlen=_HISTORY)
        self.forces: deque[float] = deque(maxlen=_HISTORY)

    def frame(self, env_id: int = 0, info: Mapping[str, Any] | None = None) -> np.ndarray:
        """Draw a world as it is now.

        Args:
            env_id: World to draw.
            info: Further numbers to show, by label; ``reward`` replaces the environment's.

        Returns:
            Picture, uint8, shape (H, W, 3) with even H and W.
        """
        patient = self._colon.patient_of(env_id)
        if patient is not self._patient:
            self._show(patient)
        shown = read_info(self._env, env_id, info, self.cfg.metrics)
        self._remember(env_id, shown)
        height, width = self.cfg.outside.height, self.cfg.outside.width
        size = (height + width + 3 * _MARGIN, height + 2 * _MARGIN + _PANEL_HEIGHT)
        picture = Image.new("RGB", (size[0] + size[0] % 2, size[1] + size[1] % 2), DARK)
        picture.paste(self._endoscope_view(env_id, height), (_MARGIN, _MARGIN))
        corner = (height + 2 * _MARGIN, _MARGIN)
        picture.paste(Image.fromarray(self._outside_view(env_id)), corner)
        draw = ImageDraw.Draw(picture)
        tiers = self._tiers if self.cfg.outside.scope_color == "force" else None
        draw_legends(draw, corner, self._outside.camera, self._outside.scale, tiers)
        panel = (_MARGIN, height + 2 * _MARGIN, size[0] - _MARGIN, size[1] - _MARGIN)
        draw_panel(draw, panel, shown, self._bounds, self.rewards, self.forces, self._tiers)
        return np.asarray(picture)

    def _show(self, patient: Patient) -> None:
        """Build the surface of a patient and what is drawn from it."""
        scope, visual = self._scope.stage, patient.visual
        self._patient, self._bounds = patient, patient.bounds
        self._surface = SkinnedSurface(visual, patient.wall, 1, str(self._colon.nodal_pos_wp.device))
        self._outside = OutsideView(
            self.cfg.outside,
            self._surface,
            visual.points,
            scope.link_length,
            scope.link_radius,
            self._scope.data.window_arc.cpu().numpy(),
            scope.bending_links,
            self._tiers,
        )
        is_painted = self.cfg.outside.wall_color != "displacement"
        self._paint = WallPaint(self._colon, patient) if is_painted else None

    def _endoscope_view(self, env_id: int, size: int) -> Image.Image:
        if "camera" in self._env.scene.keys():
            rgb, _ = self._env.scene["camera"].snapshot_view(env_id, size, self.cfg.samples)
            return octagon(rgb)
        picture = Image.new("RGB", (size, size), DARK)
        draw = ImageDraw.Draw(picture)
        draw.text((size / 2, size / 2), "no camera", fill=DIM_INK, font=font(18), anchor="mm")
        return picture

    def _outside_view(self, env_id: int) -> np.ndarray:
        self._surface.update(self._colon.nodal_pos_wp[:, env_id : env_id + 1])
        data = self._scope.data
        position, quaternion = data.body_pos_w[env_id].cpu().numpy(), data.body_quat_w[env_id].cpu().numpy()
        force = data.window_force_norm[env_id].cpu().numpy()
        values = self._wall_values(env_id, position, quaternion)
        return self._outside.render(position, quaternion, force, values)

    def _wall_values(self, env_id: int, position: np.ndarray, quaternion: np.ndarray) -> np.ndarray | None:
        if self._paint is None:
            return None
        if self.cfg.outside.wall_color == "strain":
            return self._paint.strain(env_id)
        if self.cfg.outside.wall_color == "tension":
            return self._paint.tension(env_id)
        data, link_length = self._scope.data, self._scope.stage.link_length
        read = (data.link_force_norm[env_id] > 0.0, data.window_force_norm[env_id], data.window_arc)
        force = window_at_links(link_length, *(values.cpu().numpy() for values in read))
        return self._paint.force(env_id, position, quaternion, link_length, force)

    def _remember(self, env_id: int, info: FrameInfo) -> None:
        """Add to the charts, which start again with every episode and world."""
        if env_id != self._env_id or info.time < self._time:
            self.rewards.clear()
            self.forces.clear()
        self._env_id, self._time = env_id, info.time
        self.rewards.append(float("nan") if info.reward is None else info.reward)
        self.forces.append(info.max_force)
