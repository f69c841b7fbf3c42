# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The abdomen around the colon: an assistant's hand on it as an action and an observation, other bodies and sheets by
events."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from arcgym.envs.mdp.actions import VelocityAction
from arcgym.managers import ActionTerm, ActionTermCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import NON_NEGATIVE, Range, expects, require

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv

__all__ = [
    "HandPressureAction",
    "HandPressureActionCfg",
    "hand",
    "randomize_abdomen",
    "randomize_loop_friction",
    "randomize_mesentery",
]


class HandPressureAction(VelocityAction):
    """Force of an assistant's hand on the abdomen, none below zero, and where the hand moves on it; D = 3.

    The hand's place moves once a control step, at the commanded velocity, and stays on the front of the abdomen.
    """

    cfg: HandPressureActionCfg
    axes = ("press", "right", "cranial")
    units = ("N", "m/s", "m/s")

    def __init__(self, cfg: HandPressureActionCfg, env: ManagerBasedEnv) -> None:
        """Check that there is an abdomen.

        Raises:
            ValueError: If there is none.
        """
        super().__init__(cfg, env, [cfg.force, cfg.speed, cfg.speed], {})
        self._place = self._asset.data.hand_place.clone()

    def process_actions(self, actions: torch.Tensor) -> None:
        """Clip and scale ``actions``, shape (N, 3), and move the hand by one control step."""
        super().process_actions(actions)
        reach = self._processed[:, 1:] * self._env.step_dt
        self._place = (self._asset.data.hand_place + reach).clamp(-self.cfg.reach, self.cfg.reach)

    def apply_actions(self) -> None:
        """Command the hand."""
        self._asset.set_hand_pressure(self._processed[:, 0], self._place)

    def commanded_actions(self) -> torch.Tensor:
        """Return zeros, shape (N, 3): no expert has an assistant."""
        return torch.zeros_like(self._raw)


@configclass
class HandPressureActionCfg(ActionTermCfg):
    """Configuration of :class:`HandPressureAction`."""

    class_type: type[ActionTerm] | str = HandPressureAction
    """The term's class."""

    asset_name: str = "colon"
    """Scene element around which the abdomen is."""

    force: float = 40.0
    """Force at a raw action of one [N]. A choice, half way between 20 and 60 N: no source says how hard assistants
    press; how the front of the abdomen resists is ``AbdomenCfg.hand_stiffness``."""

    speed: float = 0.1
    """Speed of the hand on the abdomen at a raw action of one [m/s], along each of two directions. A choice."""

    reach: float = 0.2
    """Farthest way of the hand from where it is at first, along each of them [m]."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "force", Range(0.0, 100.0, above=True), unit="N")
        require(self, "speed", Range(0.0, 1.0, above=True), unit="m/s")
        require(self, "reach", Range(0.0, 0.5), unit="m")


def hand(env: ManagerBasedEnv) -> torch.Tensor:
    """Return how deep the hand has pressed the abdomen in, and where it is, over 0.1 m, shape (N, 3)."""
    data = env.scene["colon"].data
    return torch.cat([data.hand_dent[:, None], data.hand_place], dim=1) / 0.1


@expects(gap=NON_NEGATIVE, stiffness=NON_NEGATIVE)
def randomize_abdomen(
    env: ManagerBasedEnv,
    env_ids: torch.Tensor,
    gap: tuple[float, float] | None = (0.0, 0.03),
    stiffness: tuple[float, float] | None = (2.0e5, 5.0e5),
) -> None:
    """Give each world a body of its own, uniform between bounds; needs ``env.scene.colon.abdomen.enabled=true``.

    Args:
        gap: Least and largest way from the imaged colon to the inside of the abdomen [m]; None leaves it as it is. A
            choice.
        stiffness: Pressure over depth [Pa/m], 2 to 5 kPa a cm, a choice.
    """
    drawn = _uniform(env, env_ids, "abdomen", gap=gap, stiffness=stiffness)
    env.scene["colon"].write_abdomen_to_sim(**drawn, env_ids=env_ids)


@expects(fullness=Range(1.0), stiffness=NON_NEGATIVE)
def randomize_mesentery(
    env: ManagerBasedEnv,
    env_ids: torch.Tensor,
    fullness: tuple[float, float] | None = (1.0, 1.4),
    stiffness: tuple[float, float] | None = None,
) -> None:
    """Give each world sheets of its own, uniform between bounds; needs ``env.scene.colon.mesentery.enabled=true``.

    Args:
        fullness: Least and largest length of the sheets over that as imaged; None leaves it as it is. By default up to
            one standard deviation of the sigmoid's height more.
        stiffness: Young's modulus times thickness of the sheets [N/m].
    """
    drawn = _uniform(env, env_ids, "mesentery", fullness=fullness, stiffness=stiffness)
    env.scene["colon"].write_mesentery_to_sim(**drawn, env_ids=env_ids)


@expects(friction=NON_NEGATIVE)
def randomize_loop_friction(
    env: ManagerBasedEnv, env_ids: torch.Tensor, friction: tuple[float, float] = (0.034, 0.078)
) -> None:
    """Give each world a friction between loops, uniform between bounds; needs ``env.sim.loops.enabled=true``.

    Args:
        friction: Least and largest Coulomb coefficient; the default is the range of rats' abdominal walls.
    """
    drawn = _uniform(env, env_ids, "loops", friction=friction)
    env.sim.write_loop_friction(**drawn, env_ids=env_ids)


def _uniform(
    env: ManagerBasedEnv, env_ids: torch.Tensor, what: str, **bounds: tuple[float, float] | None
) -> dict[str, torch.Tensor]:
    """Return a number between each two bounds for some worlds, shape (n,), by name; none where there are no bounds."""
    return {
        name: pair[0] + (pair[1] - pair[0]) * env.random.uniform(f"{what}: {name}", env_ids=env_ids)
        for name, pair in bounds.items()
        if pair is not None
    }
