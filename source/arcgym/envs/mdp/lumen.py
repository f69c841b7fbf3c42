# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The paper's lumen reward: arithmetic on the depth image, on the whole batch at once.

With the depth image ``D`` [m], clipped at a far plane, of ``H x W`` pixels per world:

* deep region ``S_d = {D >= tau}``, ``tau = depth_threshold * max D``;
* ``s_c = 1 - r / r_max``: ``r`` is the distance [pixels] from the mean row and column of ``S_d`` to the image center
  ``((H - 1) / 2, (W - 1) / 2)``, ``r_max`` half the image diagonal;
* ``s_1 = clamp((d_max - tau_wall) / (tau_lumen - tau_wall), 0, 1)``: far enough to be lumen and not wall;
* ``s_2 = clamp((rho_d - rho_min) / (1 - rho_min), 0, 1)``, ``rho_d = |S_d| / (H W)``: size of the deep region;
* ``s_3 = clamp((d_max - d_min - delta_min) / (delta_good - delta_min), 0, 1)``: depth contrast;
* ``s_o = 2 (mix s_1 + (1 - mix) s_2) s_3 - 1``: visibility, in [-1, 1];
* ``R = w_c s_c + w_o s_o``.

Source: "ARCGym: Benchmarking Deep Reinforcement Learning in Autonomous Robotic Colonoscopy", RA-L 2026. What the text
leaves open, and how it is read here:

* ``rho_d`` is not defined in the text. It is the fraction of pixels in ``S_d`` here; the original code counts pixels
  with ``D >= d_min + 0.7 (d_max - d_min)`` instead.
* The symbol beta names both the depth threshold and the mixing weight of ``s_1`` and ``s_2``; the original code has
  different values for them (0.7 and 0.6), so they are two fields here.
* ``R`` lies in ``[-w_o, w_c + w_o]``, because ``s_c >= 0``; the text's (-1, 1) is only a bound for weights that sum
  to one. ``s_c`` can be high inside a diverticulum; only ``s_o`` tells it from the lumen.
* ``s_2`` grows where the image is filled by one flat wall and is small in an open lumen (its deep region is a few per
  cent of the image); ``s_3`` has to suppress the wall, so ``delta_min`` must exceed the contrast seen when facing it.
* The kind of depth and the far plane are not given: here ``D`` is the distance along the ray, and ``far`` clips it.
* The original code adds guards that the text does not have (reward -1 when ``d_min`` is below 1 mm, threshold 0.2 in
  nearly flat images, +1 at the goal); they are left out.
* No field of view is given, and the reward depends on it: with a wide lens the lumen stays in view at 45 degrees off
  the axis, so that ``R`` falls mainly through ``s_c``.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import torch
import warp as wp

from arcgym.envs.mdp.lumen_cuda_kernels import score_images_together
from arcgym.envs.mdp.lumen_kernels import LumenConstants, score_images
from arcgym.envs.mdp.settings import task_setting
from arcgym.utils.configclass import configclass, copy
from arcgym.utils.string import did_you_mean
from arcgym.utils.validation import (
    Range,
    require,
    require_fraction,
    require_non_negative,
    require_order,
    require_positive,
)
from arcgym.utils.warp_block_kernels import LANES

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


__all__ = [
    "LUMEN_PRESETS",
    "METRIC",
    "PAPER",
    "LumenCfg",
    "LumenScores",
    "lumen_scores",
    "resolve_lumen",
    "score_depth",
]


@configclass
class LumenCfg:
    """Constants of the lumen reward; the defaults are the preset ``paper``."""

    depth_threshold: float = 0.7
    """Deep pixels have at least this fraction of the largest depth. Raise it to follow only the far end."""

    mix: float = 0.6
    """Weight of ``s_1`` against ``s_2`` in the visibility. Raise it where the lumen is wide and open."""

    tau_wall: float = 0.005
    """Largest depth [m] at which the view is still nothing but wall (``s_1 = 0``)."""

    tau_lumen: float = 0.020
    """Largest depth [m] from which on the view is surely lumen (``s_1 = 1``)."""

    rho_min: float = 0.2
    """Fraction of deep pixels at which ``s_2`` starts to grow."""

    delta_min: float = 0.004
    """Depth contrast [m] below which the view counts as flat (``s_3 = 0``)."""

    delta_good: float = 0.012
    """Depth contrast [m] from which on the view is surely a tube (``s_3 = 1``)."""

    weight_centering: float = 0.5
    """``w_c``, weight of the centering ``s_c``."""

    weight_visibility: float = 0.5
    """``w_o``, weight of the visibility ``s_o``."""

    far: float = 1.0
    """Depth is clipped here [m] first. Lower it so that one distant pixel does not become the whole deep region."""

    @classmethod
    def from_name(cls, name: str) -> LumenCfg:
        """Return a copy of the preset of that name, for ``env.lumen=metric`` on the command line.

        Raises:
            ValueError: If there is no such preset, with the nearest names.
        """
        return copy(resolve_lumen(name))

    def validate_config(self) -> None:
        """Check bounds and that every ramp rises.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "depth_threshold", Range(0.0, 1.0, above=True))
        require_fraction(self, "mix")
        require_non_negative(self, "tau_wall", "delta_min", unit="m")
        require_positive(self, "tau_lumen", "delta_good", "far", unit="m")
        require_order(self, "tau_wall", "tau_lumen", unit="m")
        require_order(self, "delta_min", "delta_good", unit="m")
        require(self, "rho_min", Range(0.0, 1.0, below=True))
        require_non_negative(self, "weight_centering", "weight_visibility")

    def key(self) -> tuple[float, ...]:
        """Return the constants in the order of the fields, by which scores are kept."""
        return tuple(vars(self).values())


PAPER = LumenCfg()
"""The constants of the original code, in meters (0.01 of its stage units is 1 mm of colon).

In a metric colon ``s_1`` and ``s_3`` are one and ``s_2`` is zero unless the wall is closer than about 1 cm. So
``s_o`` is 0.2 nearly everywhere and ``R`` follows the centering: about 0.5 looking along the lumen, 0.3 at 45 degrees
off, and 0.3, 0.1 and -0.1 facing the wall at 12, 6 and 3 mm (means over colon 1, measured with
scripts/benchmarks/lumen_reward.py)."""

METRIC = LumenCfg(
    depth_threshold=0.9,
    mix=0.9,
    tau_wall=0.025,
    tau_lumen=0.075,
    rho_min=0.002,
    delta_min=0.018,
    delta_good=0.060,
    weight_centering=0.4,
    weight_visibility=0.6,
    far=0.10,
)
"""The same equations with constants for a colon of real size and a lens of 150 degrees.

The ramps of ``s_1`` and ``s_3`` lie between what a camera sees facing the wall (at 12 mm the largest depth is 3 cm,
the contrast 2 cm) and along the lumen (11 and 9 cm). The mixing weight is 0.9 because the deep region of an open
lumen is a few per cent of the image, which bounds ``s_o`` by about ``2 mix - 1``. ``R`` is about 0.8 looking along
the lumen, 0.75, 0.7, 0.6, 0.45 and -0.15 at 15, 30, 45, 60 and 90 degrees off, and -0.25, -0.35 and -0.45 facing the
wall at 12, 6 and 3 mm (means over colon 1, measured with scripts/benchmarks/lumen_reward.py)."""

LUMEN_PRESETS: dict[str, LumenCfg] = {"paper": PAPER, "metric": METRIC}
"""Presets by name; add your own here to select it with ``env.lumen=<name>``."""


@dataclass(frozen=True)
class LumenScores:
    """Parts of the lumen reward, one entry a world; every tensor is float32."""

    s_c: torch.Tensor
    """Centering of the deep region in [0, 1], shape (N,)."""

    s_1: torch.Tensor
    """Lumen against wall by the largest depth in [0, 1], shape (N,)."""

    s_2: torch.Tensor
    """Size of the deep region in [0, 1], shape (N,)."""

    s_3: torch.Tensor
    """Depth contrast in [0, 1], shape (N,)."""

    s_o: torch.Tensor
    """Visibility of the lumen in [-1, 1], shape (N,)."""

    reward: torch.Tensor
    """``R``, shape (N,)."""

    center: torch.Tensor
    """Mean row and column of the deep region [pixels], shape (N, 2)."""

    depth_min: torch.Tensor
    """Smallest depth [m], shape (N,)."""

    depth_max: torch.Tensor
    """Largest depth [m], clipped at ``far``, shape (N,)."""


def score_depth(depth: torch.Tensor, cfg: LumenCfg) -> LumenScores:
    """Score depth images ``depth`` [m], shape (N, H, W), float32, with the equations at the head of this module.

    One kernel: in torch they would be forty operations, each of them launched.
    """
    wp.init()  # for images without a simulation
    scores = torch.empty(10, len(depth), dtype=torch.float32, device=depth.device)
    images, constants = wp.from_torch(depth.float().contiguous()), _constants(cfg.key())
    outputs, device = [wp.from_torch(scores)], images.device
    if device.is_cuda:
        shape, inputs = (len(depth), LANES), [images.reshape((len(depth), -1)), depth.shape[2], LANES, constants]
        wp.launch(score_images_together, shape, inputs=inputs, outputs=outputs, device=device, block_dim=LANES)
    else:
        wp.launch(score_images, len(depth), inputs=[images, constants], outputs=outputs, device=device)
    s_c, s_1, s_2, s_3, s_o, reward, row, column, smallest, largest = scores
    return LumenScores(s_c, s_1, s_2, s_3, s_o, reward, torch.stack((row, column), dim=1), smallest, largest)


@cache
def _constants(values: tuple[float, ...]) -> LumenConstants:
    constants = LumenConstants()
    for field, value in zip(dataclasses.fields(LumenCfg), values, strict=True):
        setattr(constants, field.name, value)
    return constants


def lumen_scores(env: ManagerBasedEnv, lumen: str | LumenCfg | None = None) -> LumenScores:
    """Return the scores of the current images of ``scene["camera"]``, computed once for each and shared by all terms.

    New images are told by the camera's ``data.frame``: raise it after writing into them or replaying an update.

    Args:
        env: The environment; ``env.scene["camera"]`` must give ``depth``.
        lumen: A preset's name or the constants. None takes the task's, ``env.cfg.lumen``.
    """
    cfg = resolve_lumen(task_setting(env, "lumen", lumen))
    images = env.scene["camera"].data
    scored, scores = _CACHE.get(env, (None, {}))
    if scored != (id(images), images.frame):
        scores = {}
        _CACHE[env] = ((id(images), images.frame), scores)
    key = cfg.key()
    if key not in scores:
        scores[key] = score_depth(images.output["depth"], cfg)
    return scores[key]


def resolve_lumen(lumen: str | LumenCfg) -> LumenCfg:
    """Return the constants behind a preset's name; constants pass through.

    Raises:
        ValueError: If there is no such preset, with the nearest names.
    """
    if isinstance(lumen, LumenCfg):
        return lumen
    if lumen not in LUMEN_PRESETS:
        raise ValueError(f"There is no lumen preset '{lumen}'. {did_you_mean(lumen, LUMEN_PRESETS)}")
    return LUMEN_PRESETS[lumen]


_Scores = dict[tuple[float, ...], LumenScores]
_CACHE: WeakKeyDictionary[ManagerBasedEnv, tuple[tuple[int, int], _Scores]] = WeakKeyDictionary()
