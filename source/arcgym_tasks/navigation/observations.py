# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What the policy and the critic of a navigation task see, and what some robots can sense besides."""

from __future__ import annotations

from arcgym.envs import mdp
from arcgym.managers import ObservationGroupCfg as ObsGroup
from arcgym.managers import ObservationTermCfg as ObsTerm
from arcgym.utils.configclass import configclass


@configclass
class ObservationsCfg:
    """What the policy and the critic see."""

    @configclass
    class PolicyCfg(ObsGroup):
        """Images of the last half second, the only input that a real endoscope has; shape (N, 15, H, W), uint8."""

        concatenate_dim: int = 0
        rgb = ObsTerm(func=mdp.rgb, history_length=5)

    @configclass
    class CriticCfg(ObsGroup):
        """Privileged state for the value function, in training only; shapes and units are in the terms' docstrings."""

        lumen_direction = ObsTerm(func=mdp.tip_lumen_direction)
        centerline = ObsTerm(func=mdp.centerline_ahead)
        progress = ObsTerm(func=mdp.tip_progress)
        axis_distance = ObsTerm(func=mdp.tip_axis_distance)
        velocity = ObsTerm(func=mdp.tip_velocity)
        bending = ObsTerm(func=mdp.tip_bending)
        inserted_length = ObsTerm(func=mdp.inserted_length)
        wall_forces = ObsTerm(func=mdp.wall_forces)
        drive_forces = ObsTerm(func=mdp.drive_forces)
        lumen = ObsTerm(func=mdp.lumen_state)
        last_action = ObsTerm(func=mdp.last_action)

    @configclass
    class ForceCfg(ObsGroup):
        """What force sensors in tip and drive feel, over 10 N; shape (N, 4)."""

        tip = ObsTerm(func=mdp.tip_force_vector, scale=0.1)
        base = ObsTerm(func=mdp.base_force, scale=0.1)

    @configclass
    class ShapeCfg(ObsGroup):
        """The last 60 cm of the shaft in the tip's frame, as a fiber or magnetic imaging gives it; shape (N, 36)."""

        shaft = ObsTerm(func=mdp.shaft_shape)

    @configclass
    class InsertionCfg(ObsGroup):
        """Length of scope inside the anus [m], as its marks give it; shape (N, 1)."""

        depth = ObsTerm(func=mdp.insertion_depth)

    @configclass
    class PressureCfg(ObsGroup):
        """Pressure in the lumen over 20 mmHg, as an insufflator's gauge gives it; shape (N, 1). Needs ``env.gas``."""

        lumen = ObsTerm(func=mdp.lumen_pressure)

    policy: PolicyCfg = PolicyCfg()
    """Group of the actor."""

    critic: CriticCfg = CriticCfg()
    """Group of the critic."""

    force: ForceCfg | None = None
    """Off; ``env.extra_observations=[force]``."""

    shape: ShapeCfg | None = None
    """Off; ``env.extra_observations=[shape]``."""

    insertion: InsertionCfg | None = None
    """Off; ``env.extra_observations=[insertion]``."""

    pressure: PressureCfg | None = None
    """Off; ``env.extra_observations=[pressure]``."""


EXTRA_OBSERVATIONS = {
    "force": ObservationsCfg.ForceCfg,
    "shape": ObservationsCfg.ShapeCfg,
    "insertion": ObservationsCfg.InsertionCfg,
    "pressure": ObservationsCfg.PressureCfg,
}
"""Groups that ``env.extra_observations`` adds, by name."""


def add_observations(observations: ObservationsCfg, names: tuple[str, ...]) -> None:
    """Add groups of observations by name; groups that were given stand.

    Args:
        observations: Groups of a task; changed in place.
        names: Some of :data:`EXTRA_OBSERVATIONS`.
    """
    for name in names:
        if getattr(observations, name, None) is None:
            setattr(observations, name, EXTRA_OBSERVATIONS[name]())
