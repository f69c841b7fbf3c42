# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Metric terms of force, strain and pull ``(env, **params) -> (N,)``; each names the ``reduce`` that suits it.

Forces are between scope and wall. ``mean`` in a name is over the control step, unless the reduction says otherwise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.loads import force_limit
from arcgym.managers import ManagerTermBase, MetricsTermCfg, SceneEntityCfg
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

_ENDOSCOPE = SceneEntityCfg("endoscope")


def mean_tip_force(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Force of the tip [N] (reduce: mean, or max for the largest that lasted a control step)."""
    return env.scene["endoscope"].data.tip_force


def peak_tip_force(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Largest force of the tip in a physics step of the control step [N] (reduce: max)."""
    return env.scene["endoscope"].data.tip_force_peak


def max_wall_force(env: ManagerBasedRLEnv, asset_cfg: SceneEntityCfg = _ENDOSCOPE) -> torch.Tensor:
    """Largest force of a link [N], mean over the control step (reduce: max)."""
    return env.scene[asset_cfg.name].data.wall_force_norm[:, asset_cfg.body_ids].amax(dim=1)


def peak_base_force(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Push or pull on the base [N], mean over the control step (reduce: max)."""
    return env.scene["endoscope"].data.base_force.abs()


def tip_impulse(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Force of the tip times the control step [N s] (reduce: sum)."""
    return env.scene["endoscope"].data.tip_force * env.step_dt


def time_above(env: ManagerBasedRLEnv, limit: float | str = "unsafe") -> torch.Tensor:
    """Time in which the tip's force is above ``limit`` ([N] or a tier) [s] (reduce: sum)."""
    return (env.scene["endoscope"].data.tip_force > force_limit(env, limit)) * env.step_dt


def max_wall_strain(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Largest principal strain of the wall in a physics step of the control step (reduce: max)."""
    return env.scene["colon"].data.wall_strain_peak.amax(dim=1)


def max_anchor_tension(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Largest pull of a ring on its anchors in a physics step of the control step [N] (reduce: max)."""
    return env.scene["colon"].data.anchor_tension_peak.amax(dim=1)


class tip_force_percentile(ManagerTermBase):
    """Percentile of the tip's force over the episode so far [N] (reduce: last).

    From a histogram of the control steps, its bins evenly spaced in the logarithm between 0.01 and 100 N: the result is
    the upper edge of the percentile's bin, up to 5 % too high.
    """

    BINS = 192
    """Number of bins; neighbouring edges differ by a factor of 10^(4/192) = 1.049."""

    def __init__(self, cfg: MetricsTermCfg, env: ManagerBasedRLEnv) -> None:
        """Allocate the histograms, shape (N, BINS)."""
        super().__init__(cfg, env)
        self._edges = torch.logspace(-2.0, 2.0, self.BINS, device=env.device)
        self._counts = torch.zeros(env.num_envs, self.BINS, device=env.device)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Empty the histograms of the given worlds."""
        fill_worlds(self._counts, env_ids, 0.0)

    def __call__(self, env: ManagerBasedRLEnv, percentile: float = 95.0) -> torch.Tensor:
        """Take this step's force in and return the percentile; below 0.01 N it is zero."""
        force = env.scene["endoscope"].data.tip_force
        place = torch.searchsorted(self._edges, force.contiguous()).clamp(max=self.BINS - 1)
        self._counts.scatter_add_(1, place[:, None], torch.ones_like(force)[:, None])
        share = self._counts.cumsum(dim=1) / self._counts.sum(dim=1, keepdim=True)
        bin_ = (share < percentile / 100.0).sum(dim=1).clamp(max=self.BINS - 1)
        return torch.where(bin_ > 0, self._edges[bin_], 0.0)
