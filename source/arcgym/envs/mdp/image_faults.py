# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Pictures as they are on a bad day: an observation that takes the place of :func:`arcgym.envs.mdp.rgb`.

What lies on the wall is placed in space by the picture's depth and the camera's pose: it stays where it is while the
camera moves, and while the wall moves under it. What sits on the lens stays in the picture. Depth, and with it rewards
and metrics, is not touched. All random numbers of a world follow from its episode's seed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch
import warp as wp

from arcgym.envs.mdp import image_fault_kernels as kernels
from arcgym.managers import ManagerTermBase, ObservationTermCfg, SceneEntityCfg
from arcgym.utils.validation import NON_NEGATIVE, expects

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

__all__ = ["IMAGE_FAULTS", "impaired_rgb"]

IMAGE_FAULTS = {
    "fluid": "extinction of a turbid fluid in front of the lens [1/m]",
    "stool": "share of cells of 2 cm on the wall that hold a lump of stool",
    "bubbles": "share of cells of 6 mm on the wall that hold a bubble",
    "blur": "standard deviation of a blur, as a share of the picture's width",
    "droplets": "number of drops on the lens",
    "noise": "standard deviation of the sensor's noise, of 255",
    "dropped": "probability that the picture of a step is lost, and the one before is shown again",
}
"""What may spoil a picture, and what ``amount`` means for it."""

MURK = (140.0, 115.0, 55.0)
"""Color of the fluid, lit from the tip, 0 to 255."""

_CAMERA = SceneEntityCfg("camera")


@expects(kind=IMAGE_FAULTS, amount=NON_NEGATIVE)
class impaired_rgb(ManagerTermBase):
    """Color image with one fault, shape (N, 3, H, W), uint8."""

    def __init__(self, cfg: ObservationTermCfg, env: ManagerBasedRLEnv) -> None:
        """Allocate the picture."""
        super().__init__(cfg, env)
        image = env.scene[cfg.params.get("sensor_cfg", _CAMERA).name].data.output["rgb"]
        self._out = image.clone()
        self._between = torch.zeros(image.shape, device=env.device)
        self._seed = torch.zeros(env.num_envs, dtype=torch.int32, device=env.device)
        self._is_new = torch.ones(env.num_envs, dtype=torch.bool, device=env.device)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Place the faults of the given worlds anew."""
        worlds = slice(None) if env_ids is None else env_ids
        drawn = self._env.random.uniform("image faults", env_ids=env_ids)
        self._seed[worlds] = (drawn * 2**24).int()
        self._is_new[worlds] = True

    def __call__(
        self, env: ManagerBasedRLEnv, kind: str, amount: float, sensor_cfg: SceneEntityCfg = _CAMERA
    ) -> torch.Tensor:
        """Spoil the current picture.

        Args:
            kind: One of :data:`IMAGE_FAULTS`.
            amount: How much of it, in the unit that :data:`IMAGE_FAULTS` names; zero leaves the picture as it is.
            sensor_cfg: The camera.
        """
        camera = env.scene[sensor_cfg.name]
        if amount == 0.0:
            self._out.copy_(camera.data.output["rgb"])
        elif kind == "dropped":
            self._drop(camera.data.output["rgb"], amount)
        else:
            self._spoil(camera, kind, amount)
        return self._out.permute(0, 3, 1, 2)

    def _drop(self, image: torch.Tensor, probability: float) -> None:
        """Take the current picture over, but where it is lost; the first of an episode never is."""
        kept = (self._env.random.uniform("dropped picture") >= probability) | self._is_new
        self._out = torch.where(kept[:, None, None, None], image, self._out)
        self._is_new = torch.zeros_like(self._is_new)

    def _spoil(self, camera: object, kind: str, amount: float) -> None:
        """Launch the kernel of a fault."""
        data, renderer = camera.data, camera.renderer  # type: ignore[attr-defined]
        image, depth = wp.from_torch(data.output["rgb"]), wp.from_torch(data.output["depth"])
        seed, out, between = wp.from_torch(self._seed), wp.from_torch(self._out), self._between
        placed = [image, depth, renderer.drawn_from, renderer.rays, seed, float(amount)]
        step = wp.from_torch(self._env.episode_length_buf)  # type: ignore[attr-defined]
        deviation = float(amount) * image.shape[2]
        launches = {
            "fluid": [(kernels.turbid_fluid, [image, depth, float(amount), wp.vec3(*MURK)], out)],
            "stool": [(kernels.stool, placed, out)],
            "bubbles": [(kernels.bubbles, placed, out)],
            "droplets": [(kernels.droplets, [image, seed, int(amount)], out)],
            "noise": [(kernels.sensor_noise, [image, seed, step, float(amount)], out)],
            "blur": [
                (kernels.blur_rows, [image, deviation], wp.from_torch(between, dtype=wp.vec3)),
                (kernels.blur_columns, [wp.from_torch(between, dtype=wp.vec3), deviation], out),
            ],
        }
        for kernel, inputs, written in launches[kind]:
            wp.launch(kernel, image.shape[:3], inputs=inputs, outputs=[written], device=image.device)
