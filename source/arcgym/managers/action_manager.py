# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Actions: the parts of the action vector and what they drive."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import torch

from arcgym.managers.manager_base import ManagerBase
from arcgym.managers.term_base import ManagerTermBase
from arcgym.managers.term_cfg import ActionTermCfg
from arcgym.utils.errors import TermError
from arcgym.utils.string import did_you_mean, resolve_callable
from arcgym.utils.worlds import fill_worlds

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


class ActionTerm(ManagerTermBase, ABC):
    """Turns some entries of the action vector into commands of one asset."""

    def __init__(self, cfg: ActionTermCfg, env: ManagerBasedEnv) -> None:
        """Find the asset that ``cfg.asset_name`` names."""
        super().__init__(cfg, env)
        if cfg.asset_name not in env.scene.keys():  # noqa: SIM118 - a scene is not a dict
            raise ValueError(
                f"The scene has no asset '{cfg.asset_name}'. {did_you_mean(cfg.asset_name, env.scene.keys())}"
            )
        self._asset = env.scene[cfg.asset_name]

    @property
    @abstractmethod
    def action_dim(self) -> int:
        """Number of entries that this term takes."""

    @property
    @abstractmethod
    def raw_actions(self) -> torch.Tensor:
        """Entries as the policy gave them, shape (N, action_dim)."""

    @property
    @abstractmethod
    def processed_actions(self) -> torch.Tensor:
        """Commands made of them, in the asset's units, shape (N, ...)."""

    @abstractmethod
    def process_actions(self, actions: torch.Tensor) -> None:
        """Compute the commands of the coming control step.

        Args:
            actions: Entries of this term, shape (N, action_dim).
        """

    @abstractmethod
    def apply_actions(self) -> None:
        """Hand the commands to the asset, after every :meth:`process_actions`."""

    def resume(self, step: int, env_ids: torch.Tensor | None = None) -> None:  # noqa: B027
        """Go on in the given worlds as after so many control steps of an episode; they have been put in its state."""

    def commanded_actions(self) -> torch.Tensor:
        """Return the raw actions that come closest to what the asset is commanded now, shape (N, action_dim).

        Scripted experts command the asset itself; this is how their commands become actions.

        Raises:
            NotImplementedError: If the term does not know them.
        """
        raise NotImplementedError(f"{type(self).__name__} cannot tell actions from commands: define commanded_actions.")


class ActionManager(ManagerBase):
    """Splits the action vector among its terms."""

    term_cfg_type = ActionTermCfg

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Construct the terms; see :class:`ManagerBase`."""
        super().__init__(cfg, env)
        self._action = torch.zeros(self.num_envs, self.total_action_dim, device=self.device)
        self._prev_action = torch.zeros_like(self._action)

    @property
    def total_action_dim(self) -> int:
        """Length A of the action vector."""
        return sum(self.action_term_dim)

    @property
    def action_term_dim(self) -> list[int]:
        """Number of entries of each term."""
        return [term.action_dim for term in self._terms.values()]

    @property
    def action(self) -> torch.Tensor:
        """Last action, shape (N, A); zero after a reset."""
        return self._action

    @property
    def prev_action(self) -> torch.Tensor:
        """Action before the last, shape (N, A); zero after a reset."""
        return self._prev_action

    def get_term(self, name: str) -> ActionTerm:
        """Return a term by name."""
        return self.get_term_cfg(name)

    def process_action(self, action: torch.Tensor) -> None:
        """Take the action of the coming control step and let the terms compute their commands.

        Args:
            action: Action of every world, shape (N, A).

        Raises:
            ValueError: If the shape differs.
        """
        expected = (self.num_envs, self.total_action_dim)
        if action.shape != expected:
            raise ValueError(f"ActionManager got an action of shape {tuple(action.shape)}, expected {expected}.")
        self._prev_action.copy_(self._action)
        self._action.copy_(action.detach())
        for term, part in zip(self._terms.values(), self._action.split(self.action_term_dim, dim=1), strict=True):
            term.process_actions(part)

    def apply_action(self) -> None:
        """Hand the commands of every term to its asset."""
        for term in self._terms.values():
            term.apply_actions()

    def commanded_actions(self) -> torch.Tensor:
        """Return the raw actions that come closest to what the assets are commanded now, shape (N, A)."""
        return torch.cat([term.commanded_actions() for term in self._terms.values()], dim=1)

    def resume(self, step: int, env_ids: torch.Tensor | None = None) -> None:
        """Let the terms go on in some worlds as after so many control steps of an episode."""
        for term in self._terms.values():
            term.resume(step, env_ids)

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, Any]:
        """Set the actions of some worlds to zero and reset the terms."""
        fill_worlds(self._action, env_ids, 0.0)
        fill_worlds(self._prev_action, env_ids, 0.0)
        for term in self._terms.values():
            term.reset(env_ids)
        return {}

    def set_term_cfg(self, name: str, cfg: Any) -> None:
        """Raise: the action vector is fixed at construction."""
        raise TypeError(f"The action term '{name}' cannot be replaced: the action vector is fixed at construction.")

    def _resolve(self, name: str, term: Any) -> None:
        """Leave the configuration as it is; :meth:`_prepare_terms` constructs the term."""
        if isinstance(term.class_type, str):
            term.class_type = resolve_callable(term.class_type)
        if not (isinstance(term.class_type, type) and issubclass(term.class_type, ActionTerm)):
            raise TermError(f"Term '{name}' of ActionManager has class_type {term.class_type}, expected an ActionTerm.")

    def _prepare_terms(self) -> dict[str, Any]:
        return {name: cfg.class_type(cfg, self._env) for name, cfg in super()._prepare_terms().items()}

    def _columns(self) -> list[str]:
        return ["index", "name", "dimension"]

    def _rows(self) -> list[list[Any]]:
        return [[index, name, term.action_dim] for index, (name, term) in enumerate(self._terms.items())]
