# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Recorder term of pictures with their truth: color, depth, normals, kinds of surface and the camera's pose."""

from __future__ import annotations

from typing import Any

import torch

from arcgym.managers import RecorderTerm, RecorderTermCfg
from arcgym.managers.recorder_term import Record
from arcgym.sensors.truth_images import TruthImages
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require, require_at_least

__all__ = ["DEPTH_UNIT", "IMAGES", "PostStepImagesRecorder", "PostStepImagesRecorderCfg"]

DEPTH_UNIT = 1.0e-5
"""Distance that a step of a recorded depth stands for [m]."""
IMAGES = ("rgb", "depth", "normal", "label")
"""Kinds of pictures."""


class PostStepImagesRecorder(RecorderTerm):
    """``images/...`` after each step, larger than the policy's and from the same place.

    ``rgb`` uint8 (T, H, W, 3); ``depth`` uint16 (T, H, W), distance along the ray in units of 10 µm; ``normal`` int8
    (T, H, W, 3), 127 times the unit normal in the camera's frame; ``label`` uint8 (T, H, W), index into
    :data:`arcgym.sensors.truth_images.LABELS`; ``camera_pos_w`` (T, 3) [m] and ``camera_quat_w_opengl`` (T, 4), the
    frame that looks along -Z with +Y up. Once an episode ``images/rays`` (H, W, 3): direction of each pixel in it.
    """

    cfg: PostStepImagesRecorderCfg

    def __init__(self, cfg: PostStepImagesRecorderCfg, env: Any) -> None:
        """Allocate pictures of all worlds."""
        super().__init__(cfg, env)
        scene, size = env.scene, (cfg.width, cfg.height)
        self._truth = TruthImages(scene[cfg.camera], scene["colon"].patients, size, cfg.samples, scene["endoscope"])
        self._rays = torch.as_tensor(self._truth.rays, device=env.device)

    def record_post_step(self) -> Record:
        """Return the pictures of the state after the step."""
        images = self._truth.draw(self._env.scene[self.cfg.camera].poses_wp)
        values = {
            "rgb": images["rgb"],
            "depth": (images["depth"] / DEPTH_UNIT).round().clamp(0, 65535).to(torch.uint16),
            "normal": (images["normal"] * 127.0).round().to(torch.int8),
            "label": images["label"],
        }
        pose = {"camera_pos_w": images["pose"][:, :3], "camera_quat_w_opengl": images["pose"][:, 3:]}
        return "images", {name: values[name] for name in self.cfg.types} | pose

    def record_post_reset(self, env_ids: torch.Tensor) -> Record:
        """Return the directions of the pixels."""
        return "images", {"rays": self._rays.expand(len(env_ids), *self._rays.shape)}


@configclass
class PostStepImagesRecorderCfg(RecorderTermCfg):
    """Records pictures with their truth; a frame of 256 x 256 px takes some 250 kB."""

    class_type: Any = PostStepImagesRecorder

    width: int = 256
    """Width [px]; the policy's camera keeps its own."""

    height: int = 256
    """Height [px]."""

    samples: int = 2
    """Rays a pixel of the color. 1 is faster, 4 gives the smoothest edges."""

    types: tuple[str, ...] = IMAGES
    """Which pictures: any of ``rgb``, ``depth``, ``normal`` and ``label``."""

    camera: str = "camera"
    """Camera of the scene whose place, lens and lights are used."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "width", Range(1, 4096), unit="px")
        require(self, "height", Range(1, 4096), unit="px")
        require_at_least(self, 1, "samples")
        require(self, "types", IMAGES)
