# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Metric terms of the shaft's shape and of how the tip moves ``(env, **params) -> (N,)``.

Loops are told apart as with magnetic imaging of the shaft seen from the front (Shah et al., Gastrointest. Endosc. 52:1,
2000; Williams in Colonoscopy: Principles and Practice, 2nd ed., 2009): up to the end of the descending colon,

* **alpha**: the shaft crosses itself, and the loop is a right-handed screw, which a clockwise turn takes out;
* **reverse alpha**: it crosses itself the other way round;
* **N**: no crossing, but the shaft comes down after it has risen, and rises again.

Our choices: passes of a crossing are 15 cm of shaft apart or more, and an N comes down and rises again by 4 cm. Where
the shaft crosses itself more than once, the crossing nearest to the anus counts. A colon's own
course at rest can be an N.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
import torch
import warp as wp

from arcgym.anatomy.segments import SEGMENTS
from arcgym.assets.materials import MESOCOLON_HEIGHT
from arcgym.envs.mdp import shaft_kernels
from arcgym.managers import ManagerTermBase, MetricsTermCfg
from arcgym.utils.math import norm
from arcgym.utils.validation import expects
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedRLEnv
    from arcgym.scene import InteractiveScene

__all__ = ["LOOPS", "loop_rate", "loop_type", "mesentery_stretch", "paradoxical_motion", "path_efficiency"]

LOOPS = ("none", "n", "alpha", "reverse_alpha")
"""Kinds of loops; the position of a name is its number."""
SHORTEST_LOOP = 0.15
"""Length of shaft between the two passes of a crossing, at least [m]: a circle of 48 mm."""
SMALLEST_N = 0.04
"""Height by which the shaft of an N comes down and rises again, at least [m]."""
STILL = 1.0e-4
"""Insertion in a control step below which the scope counts as held [m]."""


def loop_type(env: ManagerBasedRLEnv) -> torch.Tensor:
    """Kind of loop of the shaft, index into :data:`LOOPS`, shape (N,), int32 (reduce: last).

    A free capsule has none.
    """
    now = (env.common_step_counter, env.sim.written_states)  # resets and undos write states
    found, kinds = _CACHE.get(env, (None, None))
    if kinds is None or found != now:
        kinds = find_loops(env.scene)
        _CACHE[env] = (now, kinds)
    return kinds


@expects(kind=LOOPS)
def loop_rate(env: ManagerBasedRLEnv, kind: str) -> torch.Tensor:
    """Whether the shaft has a loop of a kind, bool, shape (N,) (reduce: mean, the share of the time).

    Args:
        kind: One of :data:`LOOPS`.
    """
    return loop_type(env) == LOOPS.index(kind)


class paradoxical_motion(ManagerTermBase):
    """Length of scope pushed in while the tip slid back, in this control step [m], shape (N,) (reduce: sum).

    The shaft loops instead of advancing the tip. Zero for a free capsule, and in the first step of an episode.
    """

    def __init__(self, cfg: MetricsTermCfg, env: ManagerBasedRLEnv) -> None:
        """Forget every world's previous step."""
        super().__init__(cfg, env)
        self._past = torch.full((env.num_envs, 2), torch.nan, device=env.device)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Forget the previous step of the given worlds."""
        fill_worlds(self._past, env_ids, torch.nan)

    def __call__(self, env: ManagerBasedRLEnv) -> torch.Tensor:
        """Compare insertion and arc length with those of the last call."""
        data = env.scene["endoscope"].data
        now = torch.stack((data.inserted_length, data.tip_arc_length), dim=1)
        pushed, advanced = torch.nan_to_num(now - self._past, nan=0.0).unbind(dim=1)
        self._past.copy_(now)
        return torch.where((pushed > STILL) & (advanced < 0.0), pushed, 0.0)


class path_efficiency(ManagerTermBase):
    """Way along the lumen between start and end of the episode over the tip's path in space, shape (N,) (reduce: last).

    Near one where the tip moves straight on, low where it searches, oscillates or slips back; zero before it has moved
    5 mm. It can exceed one a little: where the tip cuts bends, its path is shorter than the centerline.
    """

    SHORTEST = 0.005
    """Path before which there is no efficiency [m]."""

    def __init__(self, cfg: MetricsTermCfg, env: ManagerBasedRLEnv) -> None:
        """Start every world's path anew."""
        super().__init__(cfg, env)
        self._tip = torch.full((env.num_envs, 3), torch.nan, device=env.device)
        self._start = torch.full((env.num_envs,), torch.nan, device=env.device)
        self._path = torch.zeros(env.num_envs, device=env.device)

    def reset(self, env_ids: torch.Tensor | None = None) -> None:
        """Start the path of the given worlds anew."""
        fill_worlds(self._tip, env_ids, torch.nan)
        fill_worlds(self._start, env_ids, torch.nan)
        fill_worlds(self._path, env_ids, 0.0)

    def __call__(self, env: ManagerBasedRLEnv) -> torch.Tensor:
        """Add this step's motion to the path."""
        data = env.scene["endoscope"].data
        self._path += torch.nan_to_num(norm(data.tip_pos_w - self._tip), nan=0.0)
        self._tip.copy_(data.tip_pos_w)
        self._start = torch.where(self._start.isnan(), data.tip_arc_length, self._start)
        way = (data.tip_arc_length - self._start).abs()
        return torch.where(self._path > self.SHORTEST, way / self._path.clamp(min=self.SHORTEST), 0.0)


class mesentery_stretch(ManagerTermBase):
    """Largest way of a ring of the sigmoid or transverse colon beyond its mesentery's slack [m], shape (N,).

    Reduce: max. In a tissue without slack it is the ring's displacement; with mesenteries that are sheets
    (``MesenteryCfg``), what the way from the root exceeds the sheet's length by. Pain in colonoscopy comes mainly from
    loops that stretch the mesentery (Shah et al., Gastrointest. Endosc. 55, 2002); 79 % of 650 pain episodes in 102
    patients came with a loop (Shah et al., Endoscopy 34:435, 2002).
    """

    def __init__(self, cfg: MetricsTermCfg, env: ManagerBasedRLEnv) -> None:
        """Keep each patient's rings at rest, shape (P, R, 3), and their slack, shape (P, R)."""
        super().__init__(cfg, env)
        colon, device = env.scene["colon"], env.device
        self._sheets = colon.cfg.mesentery.enabled
        if self._sheets:
            return
        rest, slack = zip(*(_mesentery(colon, index) for index in range(len(colon.patients))), strict=True)
        self._rest = torch.tensor(np.stack(rest), dtype=torch.float32, device=device)
        self._slack = torch.tensor(np.stack(slack), dtype=torch.float32, device=device)

    def __call__(self, env: ManagerBasedRLEnv) -> torch.Tensor:
        """Compare the rings with where they rest, or with the length of their sheets."""
        data = env.scene["colon"].data
        if self._sheets:
            return data.mesentery_stretch.amax(dim=1)
        patient = data.patient.long()
        moved = norm(data.centerline_pos_w - self._rest[patient])
        return (moved - self._slack[patient]).clamp(min=0.0).amax(dim=1)


def _mesentery(colon: Any, patient: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a patient's ring centers at rest [m], shape (R, 3), and slack [m], (R,), infinite without mesentery."""
    wall = colon.patients[patient].wall
    inner = wall.layer == 0
    center, slack = np.zeros((len(wall.ring_arc), 3)), np.zeros(len(wall.ring_arc))
    np.add.at(center, wall.ring[inner], wall.points[inner])
    np.maximum.at(slack, wall.ring, colon.anchor_springs(patient).slack)
    hangs = np.isin(wall.segment, [SEGMENTS.index(name) for name in MESOCOLON_HEIGHT])
    slack[np.setdiff1d(np.arange(len(slack)), wall.ring[hangs])] = np.inf
    return center / np.bincount(wall.ring[inner])[:, None], slack


def find_loops(scene: InteractiveScene) -> torch.Tensor:
    """Return the kind of loop of the shaft in each world of a scene, index into :data:`LOOPS`, shape (N,), int32."""
    wp.init()  # for tensors without a simulation
    scope, colon = scene["endoscope"].data, scene["colon"].data
    links, num_envs = scope.body_pos_w.contiguous(), len(scope.body_pos_w)
    kinds = torch.zeros(num_envs, dtype=torch.int32, device=links.device)
    if links.shape[1] < 3:
        return kinds
    last = colon.segment_spans[:, SEGMENTS.index("descending"), 1].contiguous()
    counts = torch.zeros(num_envs, links.shape[1], dtype=torch.bool, device=links.device)
    first = torch.full((num_envs,), int(shaft_kernels.NO_CROSSING), dtype=torch.int32, device=links.device)
    positions, marks, crossing = wp.from_torch(links, dtype=wp.vec3), wp.from_torch(counts), wp.from_torch(first)
    rings = wp.from_torch(colon.centerline_pos_w.contiguous(), dtype=wp.vec3)
    device = positions.device
    wp.launch(
        shaft_kernels.link_places,
        counts.shape,
        inputs=[positions, rings, wp.from_torch(colon.centerline_arc.contiguous()), wp.from_torch(last)],
        outputs=[marks],
        device=device,
    )
    wp.launch(
        shaft_kernels.find_crossings,
        (num_envs, links.shape[1] - 1),
        inputs=[positions, marks, SHORTEST_LOOP],
        outputs=[crossing],
        device=device,
    )
    wp.launch(
        shaft_kernels.classify,
        num_envs,
        inputs=[positions, marks, crossing, SMALLEST_N],
        outputs=[wp.from_torch(kinds)],
        device=device,
    )
    return kinds


_CACHE: WeakKeyDictionary[ManagerBasedRLEnv, tuple[tuple[int, int], torch.Tensor]] = WeakKeyDictionary()
