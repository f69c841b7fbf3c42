# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Mucosa and polyps that the camera has seen: terms ``(env, **params) -> (N,)`` for rewards and metrics.

The rays of the picture decide, on the surface that the camera sees (:mod:`arcgym.sensors.seen_surface`). What is behind
a fold, farther away than ``reach`` or in front of a covered lens is not seen. Coverage is a share of the whole colon's
mucosa; Freedman et al. (IEEE Trans. Med. Imaging 39, 2020) define it as a share, too, but of one stretch at a time. The
reach of 50 mm and the nine pixels that show a polyp are our choices. The picture after a reset does not count, the
first step's does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import torch

from arcgym.managers import ManagerTermBase, ManagerTermBaseCfg
from arcgym.sensors.seen_surface import SeenSurface
from arcgym.utils.validation import POSITIVE, Range, expects
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv, ManagerBasedRLEnv

__all__ = ["coverage", "coverage_gain", "num_polyps", "polyp_time", "polyps_seen"]

REACH = 0.05
"""Distance from the lens up to which mucosa counts as seen [m]."""


class _SeenTerm(ManagerTermBase):
    """A term whose memory is the marks of the environment."""

    def __init__(self, cfg: ManagerTermBaseCfg, env: ManagerBasedRLEnv) -> None:
        """Make the marks, unless another term has; they are an attribute so that an undo finds them."""
        super().__init__(cfg, env)
        self._marks = _seen(env, cfg.params.get("reach", REACH)).memory

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget what was seen in the given worlds."""
        if self._env in _MARKS:
            _MARKS[self._env][1].reset(env_ids)


@expects(reach=POSITIVE)
class coverage(_SeenTerm):
    """Share of the colon's mucosa that was seen since the episode began, in [0, 1], shape (N,) (reduce: last)."""

    def __call__(self, env: ManagerBasedRLEnv, reach: float = REACH) -> torch.Tensor:
        """Mark what the last picture shows.

        Args:
            reach: Distance from the lens up to which mucosa counts as seen [m]; the same in all terms of a task.
        """
        return _seen(env, reach).coverage


@expects(reach=POSITIVE)
class coverage_gain(_SeenTerm):
    """Share of the colon's mucosa that was seen for the first time in this control step, shape (N,), for rewards."""

    def __init__(self, cfg: ManagerTermBaseCfg, env: ManagerBasedRLEnv) -> None:
        """Start with nothing seen."""
        super().__init__(cfg, env)
        self._before = torch.zeros(env.num_envs, device=env.device)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget what was seen in the given worlds."""
        super().reset(env_ids)
        fill_worlds(self._before, env_ids, 0.0)

    def __call__(self, env: ManagerBasedRLEnv, reach: float = REACH) -> torch.Tensor:
        """Mark what the last picture shows.

        Args:
            reach: Distance up to which the surface counts as seen [m].
        """
        now = _seen(env, reach).coverage
        gain = now - self._before
        self._before.copy_(now)
        return gain


@expects(pixels=Range(1), reach=POSITIVE)
class polyps_seen(_SeenTerm):
    """Number of polyps that were in view since the episode began, shape (N,) (reduce: last)."""

    def __init__(self, cfg: ManagerTermBaseCfg, env: ManagerBasedRLEnv) -> None:
        """Start with none seen, shape (N, K)."""
        super().__init__(cfg, env)
        pixels = _seen(env, cfg.params.get("reach", REACH)).polyp_pixels
        self._found = torch.zeros_like(pixels, dtype=torch.bool)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget what was seen in the given worlds."""
        super().reset(env_ids)
        fill_worlds(self._found, env_ids, False)

    def __call__(self, env: ManagerBasedRLEnv, pixels: int = 9, reach: float = REACH) -> torch.Tensor:
        """Look for polyps in the last picture.

        Args:
            pixels: Pixels that must show a polyp for it to be in view.
            reach: Distance from the lens up to which it counts as seen [m].
        """
        self._found |= _seen(env, reach).polyp_pixels >= pixels
        return self._found.sum(dim=1)


@expects(pixels=Range(1), reach=POSITIVE)
class polyp_time(_SeenTerm):
    """Time for which each polyp is in view, mean over the patient's polyps, of this control step [s], shape (N,).

    Reduce: sum. Zero for a patient without polyps.
    """

    def __call__(self, env: ManagerBasedRLEnv, pixels: int = 9, reach: float = REACH) -> torch.Tensor:
        """Count the polyps in the last picture.

        Args:
            pixels: Pixels of a polyp that make it seen.
            reach: Distance up to which the surface counts as seen [m].
        """
        visible = (_seen(env, reach).polyp_pixels >= pixels).sum(dim=1)
        return visible * env.step_dt / num_polyps(env, reach).clamp(min=1)


def num_polyps(env: ManagerBasedRLEnv, reach: float = REACH) -> torch.Tensor:
    """Return the number of polyps of the world's patient, shape (N,), int (reduce: last).

    Args:
        reach: As of the other terms.
    """
    seen = _seen(env, reach)
    return seen.num_polyps[env.scene["colon"].data.patient.long()]


def _seen(env: ManagerBasedRLEnv, reach: float) -> SeenSurface:
    """Return the marks of an environment with its last pictures taken in, made at the first call."""
    camera = env.scene["camera"]
    if env not in _MARKS:
        visuals = [patient.visual for patient in env.scene["colon"].patients]
        _MARKS[env] = (-1, SeenSurface(camera, visuals, reach))
    frame, seen = _MARKS[env]
    if seen.reach != reach:
        raise ValueError(f"Terms of coverage have the reaches {seen.reach} and {reach} m, expected the same in all.")
    if frame != camera.data.frame:
        seen.look()
        _MARKS[env] = (camera.data.frame, seen)
    return seen


_MARKS: WeakKeyDictionary[ManagerBasedEnv, tuple[int, SeenSurface]] = WeakKeyDictionary()
