# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""An environment made of managers that observes and acts."""

from __future__ import annotations

import logging
from functools import cached_property
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
import torch

from arcgym.envs.manager_based_env_cfg import ManagerBasedEnvCfg
from arcgym.envs.spaces import batched, observation_space
from arcgym.managers import ActionManager, EventManager, ObservationManager, RecorderManager
from arcgym.managers.observation_manager import Observation
from arcgym.utils.configclass import validate
from arcgym.utils.garbage import paused_collection
from arcgym.utils.seed import set_seed
from arcgym.utils.string import resolve_callable
from arcgym.utils.threads import one_thread

if TYPE_CHECKING:
    from arcgym.scene import InteractiveScene

logger = logging.getLogger(__name__)


class ManagerBasedEnv(gym.Env):
    """Steps a scene under actions and returns observations, for all worlds at once.

    Observations, rewards and flags are torch tensors on :attr:`device`, in memory of their own: they may be kept.
    Steps and resets leave torch's inference mode, so that the state of terms made inside can be changed outside.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}

    @paused_collection()
    def __init__(self, cfg: ManagerBasedEnvCfg, render_mode: str | None = None) -> None:
        """Builds scene and managers.

        Args:
            cfg: Configuration; checked before anything is allocated.
            render_mode: ``"rgb_array"`` for :meth:`render`, or None.

        Raises:
            ValueError: If fields of the configuration are missing or wrong.
        """
        validate(cfg)
        self.cfg = cfg
        self.render_mode = render_mode
        self.common_step_counter = 0
        self.extras: dict[str, Any] = {"log": {}}
        self._view: Any = None
        if cfg.seed is None:
            logger.warning("No seed is set: runs will differ. Set env.seed for runs that can be repeated.")
        else:
            cfg.seed = self.seed(cfg.seed)
        self.scene = _build_scene(cfg)
        self.sim = self.scene.sim
        self.metadata = {**type(self).metadata, "render_fps": round(1.0 / self.step_dt)}
        self._refresh_all()
        self._init_buffers()
        self.load_managers()
        self.event_manager.apply("startup")
        self._refresh_all()
        self.obs_buf: dict[str, Observation] = {}

    def __repr__(self) -> str:
        """Return class, number of worlds and device in a few words; :meth:`summary` says more."""
        return f"{type(self).__name__}(num_envs={self.num_envs}, device={self.device})"

    __str__ = __repr__

    def summary(self) -> str:
        """Return clocks and a table of every manager's terms, to print once before a run."""
        clocks = (
            f"{type(self).__name__}: {self.num_envs} worlds on {self.device}, "
            f"physics {self.physics_dt:.6f} s, step {self.step_dt:.4f} s"
        )
        return "\n\n".join([clocks, *(str(manager) for manager in self._managers() if manager.active_terms)])

    @property
    def num_envs(self) -> int:
        """Number of worlds N."""
        return self.scene.num_envs

    @property
    def device(self) -> str:
        """Device of all tensors."""
        return self.scene.device

    @property
    def physics_dt(self) -> float:
        """Physics step [s]."""
        return self.cfg.sim.dt

    @property
    def step_dt(self) -> float:
        """Control step [s]."""
        return self.cfg.sim.dt * self.cfg.decimation

    @cached_property
    def single_observation_space(self) -> gym.spaces.Dict:
        """Observation of one world: a space for each group."""
        return observation_space(self.observation_manager)

    @cached_property
    def single_action_space(self) -> gym.spaces.Box:
        """Action of one world, shape (A,), unbounded: actions are clipped by their terms."""
        return gym.spaces.Box(-np.inf, np.inf, (self.action_manager.total_action_dim,), np.float32)

    @cached_property
    def observation_space(self) -> gym.Space:  # type: ignore[override]
        """Observation of all worlds. Made when it is asked for: its bounds are as large as a batch of images."""
        return batched(self.single_observation_space, self.num_envs)

    @cached_property
    def action_space(self) -> gym.Space:  # type: ignore[override]
        """Action of all worlds, shape (N, A)."""
        return batched(self.single_action_space, self.num_envs)

    @property
    def unwrapped(self) -> ManagerBasedEnv:
        """The environment itself."""
        return self

    def load_managers(self) -> None:
        """Builds the managers; terms may look at the managers built before them."""
        self.event_manager = EventManager(self.cfg.events, self)
        self.action_manager = ActionManager(self.cfg.actions, self)
        self.observation_manager = ObservationManager(self.cfg.observations, self)
        self.recorder_manager = RecorderManager(self.cfg.recorders, self)

    def seed(self, seed: int = -1) -> int:
        """Seeds every random number generator and returns the seed; a negative one draws one."""
        return set_seed(seed)

    @one_thread()
    @torch.inference_mode(False)
    @torch.no_grad()
    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, Any]]:
        """Starts a new episode in every world.

        Args:
            seed: Seed to set first; None for none.
            options: Unused; part of Gymnasium's interface.

        Returns:
            Observation of each group, and extras with the logs of the episodes cut off.
        """
        if seed is not None:
            self.seed(seed)
        self.extras = {"log": {}}
        env_ids = torch.arange(self.num_envs, device=self.device)
        self._reset_idx(env_ids)
        self._refresh_all()
        self.recorder_manager.record_post_reset(env_ids)
        self.obs_buf = self.observation_manager.compute()
        return self.obs_buf, self.extras

    @one_thread()
    @torch.inference_mode(False)
    @torch.no_grad()
    def step(self, action: torch.Tensor) -> tuple[Any, ...]:
        """Advances every world by one control step.

        Args:
            action: Action of every world, shape (N, A).

        Returns:
            Observation of each group, and extras.
        """
        self.extras = {"log": {}}
        self._advance(action)
        self.recorder_manager.record_post_step()
        self.event_manager.apply("interval", dt=self.step_dt)
        self.obs_buf = self.observation_manager.compute()
        return self.obs_buf, self.extras

    def render(self) -> np.ndarray | None:
        """Returns the picture of world ``cfg.viewer.env_id``: scope's view and outside view, uint8, shape (H, W, 3)."""
        if self.render_mode is None:
            return None
        if self._view is None:
            from arcgym.viewers import TwoPaneView

            self._view = TwoPaneView(self)
        return self._view.frame(env_id=self.cfg.viewer.env_id)

    def close(self) -> None:
        """Writes the episodes being recorded and lets go of the view. The simulation is freed with the environment."""
        self.recorder_manager.close()
        self._view = None

    def _init_buffers(self) -> None:
        """Makes what terms may read while the managers are built."""

    def _managers(self) -> list[Any]:
        return [self.event_manager, self.action_manager, self.observation_manager, self.recorder_manager]

    def _advance(self, action: torch.Tensor) -> None:
        """Applies an action for a control step of physics and updates the sensors.

        One call makes all physics steps: the simulation replays captured graphs and averages the forces over them.
        """
        self.action_manager.process_action(action.to(self.device))
        self.action_manager.apply_action()
        self.recorder_manager.record_pre_step()
        self.sim.step(self.cfg.decimation)
        self.scene.update(self.step_dt)
        self.common_step_counter += 1

    def _reset_idx(self, env_ids: torch.Tensor) -> None:
        """Puts worlds back to the start of an episode and collects the logs.

        Args:
            env_ids: World indices, int64, shape (n,).
        """
        self.recorder_manager.record_pre_reset(env_ids)
        self.scene.reset(env_ids)
        self.event_manager.apply("reset", env_ids, global_env_step_count=self.common_step_counter)
        for manager in self._managers():
            self.extras["log"].update(manager.reset(env_ids))

    def _refresh_all(self) -> None:
        """Recomputes what follows from positions, and draws every world again."""
        self.sim.forward()
        self.scene.update(0.0)


def _build_scene(cfg: ManagerBasedEnvCfg) -> InteractiveScene:
    class_type = cfg.scene.class_type
    scene_class = resolve_callable(class_type) if isinstance(class_type, str) else class_type
    return scene_class(cfg.scene, cfg.sim)
