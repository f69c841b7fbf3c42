# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Metric terms of loads ``(env, **params) -> (N,)``; each names the ``reduce`` of its config that suits it.

The loads themselves are metrics too: :func:`arcgym.envs.mdp.load`, reduced by ``max`` or ``mean``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.loads import LOADS, TIERS, force_limit, load
from arcgym.managers import ManagerTermBase, MetricsTermCfg
from arcgym.utils.validation import Range, expects
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

__all__ = ["base_force_magnitude", "load_impulse", "load_percentile", "load_time_above"]


def base_force_magnitude(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Push or pull on the base, mean over the control step [N], shape (N,) (reduce: max)."""
    return env.scene["endoscope"].data.base_force.abs()


@expects(kind=LOADS)
def load_impulse(env: ManagerBasedRLEnv, kind: str) -> torch.Tensor:
    """Load times the control step [N s], shape (N,) (reduce: sum).

    Args:
        kind: One of :data:`arcgym.envs.mdp.LOADS`.
    """
    return load(env, kind) * env.step_dt


@expects(kind=LOADS, limit=TIERS)
def load_time_above(env: ManagerBasedRLEnv, kind: str, limit: float | str) -> torch.Tensor:
    """Time in which a load is above a limit [s], shape (N,) (reduce: sum).

    Args:
        kind: One of :data:`arcgym.envs.mdp.LOADS`.
        limit: Limit [N, or strain], or the name of a tier of force.
    """
    return (load(env, kind) > force_limit(env, limit, kind)) * env.step_dt


@expects(kind=LOADS, percentile=Range(0.0, 100.0))
class load_percentile(ManagerTermBase):
    """Percentile of a load over the episode so far [N, or strain], shape (N,) (reduce: last).

    From a histogram of the control steps, its bins evenly spaced in the logarithm between a hundredth of the load's
    scale and a hundred times that: the result is the mean of the steps in the percentile's bin, which is 5 % wide, and
    so never above the largest. All values beyond the ends share a bin.
    """

    BINS = 192
    """Number of bins; neighboring edges differ by a factor of 10^(4/192) = 1.049."""

    def __init__(self, cfg: MetricsTermCfg, env: ManagerBasedRLEnv) -> None:
        """Allocate the histograms, steps and sums of their loads, shape (N, BINS) each."""
        super().__init__(cfg, env)
        self._edges = torch.logspace(-2.0, 2.0, self.BINS, device=env.device)
        self._counts = torch.zeros(env.num_envs, self.BINS, device=env.device)
        self._sums = torch.zeros_like(self._counts)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Empty the histograms of the given worlds."""
        fill_worlds(self._counts, env_ids, 0.0)
        fill_worlds(self._sums, env_ids, 0.0)

    def __call__(self, env: ManagerBasedRLEnv, kind: str, percentile: float = 95.0) -> torch.Tensor:
        """Take this step's load in and return the percentile.

        Args:
            kind: One of :data:`arcgym.envs.mdp.LOADS`.
            percentile: Share of the steps that bear less [%].
        """
        value = load(env, kind)
        place = torch.searchsorted(self._edges, value / LOADS[kind].scale).clamp(max=self.BINS - 1)
        self._counts.scatter_add_(1, place[:, None], torch.ones_like(value)[:, None])
        self._sums.scatter_add_(1, place[:, None], value[:, None])
        share = self._counts.cumsum(dim=1) / self._counts.sum(dim=1, keepdim=True)
        bin_ = (share < percentile / 100.0).sum(dim=1, keepdim=True).clamp(max=self.BINS - 1)
        return (self._sums.gather(1, bin_) / self._counts.gather(1, bin_).clamp(min=1.0)).squeeze(1)
