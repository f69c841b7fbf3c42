# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Termination terms ``(env, **params) -> (N,) bool``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.loads import anchor_load, force_limit, link_load, strain_load, tip_load
from arcgym.envs.mdp.lumen import LumenCfg, lumen_scores
from arcgym.envs.mdp.segments import has_passed
from arcgym.managers import ManagerTermBase, SceneEntityCfg, TerminationTermCfg
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv

_ENDOSCOPE = SceneEntityCfg("endoscope")


def time_out(env: ManagerBasedRLEnv) -> torch.Tensor:
    """The episode has lasted ``env.max_episode_length`` steps. A truncation: set ``time_out=True`` in its config."""
    return env.episode_length_buf >= env.max_episode_length


def segment_passed(env: ManagerBasedRLEnv, segment: str | None = None) -> torch.Tensor:
    """Success: the tip has passed the end of the segment, by arc length along the lumen."""
    return has_passed(env, segment)


def withdrawn(env: ManagerBasedRLEnv, arc_length: float = 0.0) -> torch.Tensor:
    """The tip has come back to ``arc_length`` [m] from the anal verge: the scope is out."""
    return env.scene["endoscope"].data.tip_arc_length < arc_length


def pierced(env: ManagerBasedRLEnv) -> torch.Tensor:
    """A link is going through the wall; what follows would mean nothing, for the wall does not tear.

    It takes about 100 N on one link in stiff tissue and 55 to 85 N in ``in_situ``: a full push that is kept on for 20 s
    and coils the shaft, or one with the shaft twisted to its limit.
    """
    return env.sim.pierced


def perforation(env: ManagerBasedRLEnv, limit: float | str = "perforation", peak: bool = False) -> torch.Tensor:
    """The tip presses on the wall with a force that may perforate it (``limit``: [N] or a tier).

    Mean over the control step: the limit was measured in slow pushes, and a ``peak`` of 2 ms is contact noise as well.
    """
    return tip_load(env, peak) > force_limit(env, limit)


def excess_force(
    env: ManagerBasedRLEnv,
    limit: float | str = "perforation",
    asset_cfg: SceneEntityCfg = _ENDOSCOPE,
    peak: bool = False,
) -> torch.Tensor:
    """Some link presses on the wall with more than ``limit`` ([N] or a tier), mean over the control step or its peak.

    Choose links by ``asset_cfg.body_names``. A bent shaft spreads its force and perforates later than a straight tip.
    """
    return link_load(env, asset_cfg, peak).amax(dim=1) > force_limit(env, limit)


def overstrained(env: ManagerBasedRLEnv, limit: float, peak: bool = False) -> torch.Tensor:
    """The wall is stretched by more than ``limit`` somewhere, mean over the control step or its peak.

    Colon tore at strains near 1.8 (Egorov et al. 2002, transverse strips); no safe limit in vivo is published.
    """
    return strain_load(env, peak).amax(dim=1) > limit


def anchors_overloaded(env: ManagerBasedRLEnv, limit: float, peak: bool = False) -> torch.Tensor:
    """Some ring pulls on its anchors, the mesentery, with more than ``limit`` [N]; no safe limit is published."""
    return anchor_load(env, peak).amax(dim=1) > limit


class lumen_lost(ManagerTermBase):
    """The visibility ``s_o`` has been below ``threshold`` for ``steps`` control steps in a row."""

    def __init__(self, cfg: TerminationTermCfg, env: ManagerBasedRLEnv) -> None:
        """Start every world's count at zero."""
        super().__init__(cfg, env)
        self._count = torch.zeros(env.num_envs, dtype=torch.long, device=env.device)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Start the count of the given worlds again."""
        fill_worlds(self._count, env_ids, 0)

    def __call__(
        self, env: ManagerBasedRLEnv, threshold: float = -0.4, steps: int = 5, lumen: str | LumenCfg | None = None
    ) -> torch.Tensor:
        """Count the steps without lumen. The default threshold is the original code's for its unconstrained agents."""
        lost = lumen_scores(env, lumen).s_o < threshold
        self._count = (self._count + 1) * lost
        return self._count >= steps


class stuck(ManagerTermBase):
    """The tip has advanced less than ``min_progress`` [m] over the last ``window_s`` seconds.

    A pull-back to straighten the shaft also looks like this while it lasts, so the window must leave time for one. Use
    as a truncation (``time_out=True``): it saves time and says nothing about the state's value.
    """

    def __init__(self, cfg: TerminationTermCfg, env: ManagerBasedRLEnv) -> None:
        """Allocate the ring buffer of past positions, shape (window, N)."""
        super().__init__(cfg, env)
        window = max(1, round(cfg.params["window_s"] / env.step_dt))
        self._arc = torch.full((window, env.num_envs), -torch.inf, device=env.device)
        self._next = 0

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget the past of the given worlds; they cannot be stuck before a whole window has passed."""
        fill_worlds(self._arc, env_ids, -torch.inf, dim=1)

    def __call__(self, env: ManagerBasedRLEnv, window_s: float, min_progress: float) -> torch.Tensor:
        """Compare the tip's arc length with the one of a window ago."""
        arc = env.scene["endoscope"].data.tip_arc_length
        advance = arc - self._arc[self._next]
        self._arc[self._next] = arc
        self._next = (self._next + 1) % len(self._arc)
        return advance < min_progress
