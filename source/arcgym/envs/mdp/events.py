# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Event terms ``(env, env_ids, **params)``: where an episode starts, and the differences between worlds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import torch

from arcgym.anatomy.segments import SEGMENTS
from arcgym.assets.materials import ANCHOR_SCALES, TISSUE_PRESETS, anchor_scale, tissue_preset
from arcgym.envs.mdp.settings import task_setting
from arcgym.managers import EventTermCfg, ManagerTermBase
from arcgym.sim.weight_cfg import POSTURES
from arcgym.start_states.find import ensure_all, find_stored
from arcgym.utils.validation import FRACTION, NON_NEGATIVE, POSITIVE, expects

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv, ManagerBasedRLEnv
    from arcgym.managers import TerminationManager

__all__ = [
    "change_posture",
    "perturb_tip",
    "randomize_anchors",
    "randomize_color",
    "randomize_friction",
    "randomize_light",
    "randomize_patient",
    "randomize_patient_by_failures",
    "randomize_preparation",
    "randomize_rigidity",
    "randomize_texture",
    "randomize_tissue",
    "randomize_tissue_stiffness",
    "reset_to_segment_start",
]

REST_POSE = -1
"""Snapshot index of the scope straight in the anal canal."""


@expects(segment=SEGMENTS, start=("segment", "rest"))
class reset_to_segment_start(ManagerTermBase):
    """Put worlds into the complete stored state (scope, wall, targets) whose tip is at the start of the segment.

    States come from beside the colon's stage or from the cache, and are made if there are none, see
    :mod:`arcgym.start_states`; every patient has its own. The first segment of the colon starts from the rest pose if
    none is stored, in all patients if in one.
    """

    def __init__(self, cfg: EventTermCfg, env: ManagerBasedEnv) -> None:
        """Find the state, or have it made.

        Raises:
            ValueError: If the colon does not have the segment, or its start state cannot be made.
        """
        super().__init__(cfg, env)
        segment = task_setting(env, "segment", cfg.params.get("segment"))
        start = cfg.params.get("start") or getattr(env.cfg, "start", "segment")
        self._index = torch.tensor(REST_POSE if start == "rest" else self._find(env, segment), device=env.device)

    def __call__(
        self, env: ManagerBasedEnv, env_ids: torch.Tensor, segment: str | None = None, start: str | None = None
    ) -> None:
        """Write the state.

        Args:
            segment: Name of the segment, read once at construction; None takes the task's, ``env.cfg.segment``.
            start: ``segment``, or ``rest`` to begin straight in the anus whatever the segment; None takes the task's,
                ``env.cfg.start``.
        """
        env.sim.write_snapshot(self._index, env_ids)

    @staticmethod
    def _find(env: ManagerBasedEnv, segment: str) -> int:
        loaded = () if env.sim.snapshots is None else env.sim.snapshots.names
        if segment not in loaded:
            states = _start_states(env, segment)
            if any(one is None for one in states):
                return REST_POSE
            env.sim.load_snapshots(states if len(states) == 1 else [one.only([*loaded, segment]) for one in states])
        return env.sim.snapshots.index(segment)


def _start_states(env: ManagerBasedEnv, segment: str) -> list[Any]:
    """Return the start states of every patient; None for those that begin with the segment and have none stored."""
    env.scene["colon"].require_segment(segment)
    patients = env.scene["colon"].patients
    if all(patient.bounds[segment][0] <= 0.0 for patient in patients):
        return [find_stored(env.scene, segment, index) for index in range(len(patients))]
    return ensure_all(env.scene, segment)


def randomize_patient(env: ManagerBasedEnv, env_ids: torch.Tensor) -> None:
    """Give each world one of the colon's patients, all equally likely; nothing is done where there is one.

    It must come before the reset in the same mode, which puts the scope into the new patient's start state.
    """
    colon = env.scene["colon"]
    if len(colon.patients) > 1:
        patient = env.random.integers("patient", 0, len(colon.patients), env_ids=env_ids)
        colon.write_patient_to_sim(patient, env_ids)


@expects(evenly=POSITIVE, memory=FRACTION)
class randomize_patient_by_failures(ManagerTermBase):
    """Give each world one of the colon's patients, more often those in which episodes fail.

    In place of :func:`randomize_patient`, and like it before the reset. For training alone: what a world gets depends
    on what happened in the others.
    """

    def __init__(self, cfg: EventTermCfg, env: ManagerBasedEnv) -> None:
        """Begin with patients that are all equally likely."""
        super().__init__(cfg, env)
        self.failures = torch.ones(len(env.scene["colon"].patients), device=env.device)
        """Share of the episodes in each patient that did not end in success, a running mean, shape (P,)."""

    def __call__(self, env: ManagerBasedRLEnv, env_ids: torch.Tensor, evenly: float = 0.2, memory: float = 0.9) -> None:
        """Count the episodes that have ended, and write the patients of those that begin.

        Args:
            evenly: What is added to a patient's share of failures to give its weight: with 0.2 a patient that always
                fails is drawn six times as often as one that never does.
            memory: Weight of what was before when an episode ends, in (0, 1).
        """
        colon = env.scene["colon"]
        if len(colon.patients) > 1:
            self._count(colon.data.patient[env_ids].long(), env.termination_manager, env_ids, memory)
            bounds = (evenly + self.failures).cumsum(0)
            draw = env.random.uniform("patient", env_ids=env_ids) * bounds[-1]
            patient = torch.searchsorted(bounds, draw, right=True).clamp(max=len(bounds) - 1)
            colon.write_patient_to_sim(patient, env_ids)

    def _count(self, patient: torch.Tensor, ends: TerminationManager, env_ids: torch.Tensor, memory: float) -> None:
        """Take the episodes that have just ended into the running means; worlds reset from outside do not count."""
        ended = ends.dones[env_ids].float()
        failed = ended * (~ends.success[env_ids]).float()
        zeros = torch.zeros_like(self.failures)
        number, failures = zeros.index_add(0, patient, ended), zeros.index_add(0, patient, failed)
        kept = memory**number
        self.failures = kept * self.failures + (1.0 - kept) * failures / number.clamp(min=1.0)


@expects(std=NON_NEGATIVE)
def perturb_tip(env: ManagerBasedEnv, env_ids: torch.Tensor, std: float = 0.1) -> None:
    """Turn the target of the tip by normally distributed angles about each axis, two deviations at most.

    Follows a reset in the same mode. The tip turns within the first tenths of a second, as far as the wall lets it;
    turned at once, it might start behind the wall.

    Args:
        std: Standard deviation of each angle [rad].
    """
    angle = std * env.random.normal("perturb_tip", 3, env_ids=env_ids).clamp(-2.0, 2.0)
    env.scene["endoscope"].turn_tip_target(angle, env_ids)


@expects(gain=POSITIVE, factor=POSITIVE)
def randomize_light(
    env: ManagerBasedEnv, env_ids: torch.Tensor, gain: tuple[float, float] = (0.7, 1.4), factor: float = 1.0
) -> None:
    """Scale the brightness that the automatic exposure aims at by a log-uniform factor.

    Args:
        gain: Smallest and largest factor.
        factor: Factor on what is drawn.
    """
    env.scene["camera"].write_light_gain(_log_uniform(env, "light", env_ids, gain, factor=factor), env_ids)


@expects(gain=POSITIVE)
def randomize_color(env: ManagerBasedEnv, env_ids: torch.Tensor, gain: tuple[float, float] = (0.9, 1.1)) -> None:
    """Scale red, green and blue each by a log-uniform factor: white balance and mucosa of a patient.

    Args:
        gain: Smallest and largest factor.
    """
    env.scene["camera"].write_color_gain(_log_uniform(env, "color", env_ids, gain, 3), env_ids)


def randomize_texture(env: ManagerBasedEnv, env_ids: torch.Tensor) -> None:
    """Shift the mucosa texture by a uniform offset in both directions, so that vessels are no landmarks."""
    env.scene["camera"].write_texture_offset(env.random.uniform("texture", 2, env_ids=env_ids), env_ids)


@expects(shares=FRACTION)
def randomize_preparation(
    env: ManagerBasedEnv, env_ids: torch.Tensor, shares: tuple[float, float, float] = (0.1, 0.2, 0.7)
) -> None:
    """Draw how clean the colon is: Boston bowel preparation scores of right, transverse and left colon.

    The sum of the three is 5, 6, or evenly 7, 8 or 9, and is shared out as evenly as it can be, the rest at random.
    Where what is left lies is drawn anew. Of 2352 adequate preparations 529 scored 6 and 1823 scored 7 to 9 (Kim et
    al. 2024, doi:10.1038/s41598-024-52244-8); that a tenth is less is an estimate.

    Args:
        shares: Share of worlds with a sum of 5, of 6 and of 7 to 9; they sum up to one.

    Raises:
        ValueError: If they do not.
    """
    low, middle, high = shares
    if not math.isclose(low + middle + high, 1.0, abs_tol=1.0e-6):
        raise ValueError(f"randomize_preparation: shares are {tuple(shares)}, expected three that sum up to 1.")
    draw = env.random.uniform("preparation", 5, env_ids=env_ids)
    above = (draw[:, 0] - low - middle).clamp(min=0.0) / max(high, 1.0e-9)
    good = 7 + (3.0 * above).long().clamp(max=2)
    total = torch.where(draw[:, 0] < low, 5, torch.where(draw[:, 0] < low + middle, 6, good))
    rank = draw[:, 1:4].argsort(dim=1).argsort(dim=1)
    scores = total[:, None] // 3 + (rank < total[:, None] % 3)
    env.scene["camera"].write_preparation(scores, (draw[:, 4] * 2**24).int(), env_ids)


@expects(scale=POSITIVE, factor=POSITIVE)
def randomize_tissue_stiffness(
    env: ManagerBasedEnv, env_ids: torch.Tensor, scale: tuple[float, float] = (0.5, 2.0), factor: float = 1.0
) -> None:
    """Scale Young's modulus of the wall by a log-uniform factor.

    Args:
        scale: Smallest and largest factor.
        factor: Factor on what is drawn.
    """
    drawn = _log_uniform(env, "stiffness", env_ids, scale, factor=factor)
    env.scene["colon"].write_stiffness_scale_to_sim(drawn, env_ids)


@expects(presets=TISSUE_PRESETS)
def randomize_tissue(
    env: ManagerBasedEnv, env_ids: torch.Tensor, presets: Sequence[str] = ("soft_nu049", "medium_nu049", "stiff_nu049")
) -> None:
    """Give each world Young's modulus and Poisson's ratio of one of several presets, all equally likely.

    Thickness, density and attachments stay those of ``ColonCfg``; presets that leave the two open cannot be named. Use
    it in place of :func:`randomize_tissue_stiffness`, which sets the modulus too.

    Args:
        presets: Names of tissues, see :mod:`arcgym.assets.materials`.
    """
    tissues = [tissue_preset(name) for name in presets]
    values = [(tissue.youngs_modulus, tissue.poissons_ratio) for tissue in tissues]
    chosen = _choice(env, "tissue", env_ids, values)
    env.scene["colon"].write_material_to_sim(chosen[:, 0], chosen[:, 1], env_ids)


@expects(anchors=ANCHOR_SCALES)
def randomize_anchors(
    env: ManagerBasedEnv, env_ids: torch.Tensor, anchors: Sequence[str] = ("sparse", "default", "dense")
) -> None:
    """Hold each world's colon as firmly as one of several presets says, all equally likely.

    Args:
        anchors: Names from :data:`arcgym.assets.materials.ANCHOR_SCALES`.
    """
    scales = [anchor_scale(name) for name in anchors]
    env.scene["colon"].write_anchor_scale_to_sim(_choice(env, "anchors", env_ids, scales), env_ids)


@expects(probability=FRACTION)
def randomize_rigidity(env: ManagerBasedEnv, env_ids: torch.Tensor, probability: float = 0.5) -> None:
    """Hold the wall of some worlds where it is; follows the reset in the same mode.

    Args:
        probability: Share of the worlds that are held; 1 holds all.
    """
    rigid = env.random.uniform("rigidity", env_ids=env_ids) < probability
    env.scene["colon"].write_rigid_to_sim(rigid, env_ids)


@expects(friction=POSITIVE, factor=POSITIVE)
def randomize_friction(
    env: ManagerBasedEnv, env_ids: torch.Tensor, friction: tuple[float, float] = (0.05, 0.2), factor: float = 1.0
) -> None:
    """Set the friction coefficient between scope and wall, log-uniform.

    Args:
        friction: Smallest and largest coefficient.
        factor: Factor on what is drawn.
    """
    drawn = _log_uniform(env, "friction", env_ids, friction, factor=factor)
    env.scene["endoscope"].write_friction_to_sim(drawn, env_ids)


@expects(postures=POSTURES)
def change_posture(
    env: ManagerBasedEnv, env_ids: torch.Tensor, postures: Sequence[str] = ("supine", "left_lateral")
) -> None:
    """Lay each world's patient in one of several postures, all equally likely; needs ``env.sim.weight.enabled=true``.

    At a reset the wall then begins to sag from where it was stored; in mode ``interval`` patients are turned meanwhile.

    Args:
        postures: Names from :data:`arcgym.sim.weight_cfg.POSTURES`; one alone turns all patients to it.
    """
    gravity = [env.sim.cfg.weight.gravity(name) for name in postures]
    env.sim.write_gravity(_choice(env, "posture", env_ids, gravity), env_ids)


def _choice(env: ManagerBasedEnv, tag: str, env_ids: torch.Tensor, values: Sequence[object]) -> torch.Tensor:
    """Return one of ``values`` for each of some worlds, shape (n, ...)."""
    pool = _pool(tuple(values), env.device)
    return pool[env.random.integers(tag, 0, len(pool), env_ids=env_ids)]


@cache
def _pool(values: tuple[object, ...], device: str) -> torch.Tensor:
    """Return values on the device, sent once: sending them makes the host wait for the device."""
    return torch.tensor(values, dtype=torch.float32, device=device)


def _log_uniform(
    env: ManagerBasedEnv,
    tag: str,
    env_ids: torch.Tensor,
    bounds: tuple[float, float],
    *shape: int,
    factor: float = 1.0,
) -> torch.Tensor:
    """Return numbers whose logarithm is uniform between those of ``bounds`` (positive), times a factor, (n, ...)."""
    low, high = (math.log(bound) for bound in bounds)
    drawn = torch.exp(low + (high - low) * env.random.uniform(tag, *shape, env_ids=env_ids))
    return drawn if factor == 1.0 else factor * drawn
