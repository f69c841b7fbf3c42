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
from gymnasium.vector import AutoresetMode, VectorEnv

from arcgym.envs.env_arguments import (
    check_cfg,
    check_device,
    check_render_mode,
    choose_cfg,
    refuse_unknown,
    worlds_to_reset,
)
from arcgym.envs.manager_based_env_cfg import ManagerBasedEnvCfg
from arcgym.envs.provenance import episode_facts, provenance
from arcgym.envs.spaces import batched, observation_space
from arcgym.managers import ActionManager, EventManager, ObservationManager, RecorderManager
from arcgym.managers.observation_manager import Observation
from arcgym.utils.garbage import paused_collection
from arcgym.utils.progress import report
from arcgym.utils.seed import set_seed
from arcgym.utils.string import resolve_callable
from arcgym.utils.threads import one_thread
from arcgym.utils.world_random import WorldRandom
from arcgym.utils.worlds import replace_worlds

if TYPE_CHECKING:
    from arcgym.scene import InteractiveScene

logger = logging.getLogger(__name__)


class ManagerBasedEnv(VectorEnv, gym.Env):  # type: ignore[misc]
    """Steps a scene under actions and returns observations, for all worlds at once.

    It is a :class:`gymnasium.vector.VectorEnv`, and a :class:`gymnasium.Env` because ``gymnasium.make`` asks for one.
    Actions are NumPy arrays or torch tensors. Observations, rewards and flags are torch tensors on :attr:`device` that
    no later step writes to: they may be kept, but not written to, because the next frame stack is made of the last.
    Steps and resets leave torch's inference mode: the state of terms made inside can be changed outside.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "autoreset_mode": AutoresetMode.DISABLED}

    @paused_collection()
    def __init__(
        self,
        cfg: ManagerBasedEnvCfg | None = None,
        render_mode: str | None = None,
        *,
        num_envs: int | None = None,
        device: str | None = None,
        seed: int | None = None,
        env_cfg_entry_point: str | None = None,
        **cfg_entry_points: Any,
    ) -> None:
        """Build scene and managers.

        Args:
            cfg: Configuration, checked before anything is allocated; None takes the one that the task was registered
                with.
            render_mode: ``"rgb_array"`` for :meth:`render`, or None.
            num_envs: Number of worlds, in place of ``cfg.scene.num_envs``.
            device: Device, in place of ``cfg.sim.device``.
            seed: Seed, in place of ``cfg.seed``.
            env_cfg_entry_point: The registered configuration, given by ``gymnasium.make``.
            cfg_entry_points: Configurations of learners that the task was registered with; not used here.

        Raises:
            TypeError: If there is no configuration, or an argument is unknown, with the nearest one.
            UsageError: If fields of the configuration are missing, wrong or unknown, or a term does not fit.
            ValueError: If there is no such render mode, or a term gives something else than a number a world.
        """
        refuse_unknown(cfg_entry_points)
        check_render_mode(render_mode, self.metadata["render_modes"])
        cfg = choose_cfg(cfg, env_cfg_entry_point, num_envs=num_envs, device=device, seed=seed)
        check_cfg(cfg)
        cfg.resolve()
        check_device(cfg.sim.device)
        self.cfg = cfg
        self.render_mode = render_mode
        self.common_step_counter = 0
        self.extras: dict[str, Any] = {"log": {}}
        self._view: Any = None
        self._known_ids: tuple[torch.Tensor, torch.Tensor] | None = None
        if cfg.seed is None:
            logger.warning("No seed is set: runs will differ. Set env.seed for runs that can be repeated.")
        else:
            cfg.seed = self.seed(cfg.seed)
        report("reading stages")
        self.scene: InteractiveScene = _class_of(cfg.scene)(cfg.scene, cfg.sim)
        self.sim = self.scene.sim
        self.metadata = {**type(self).metadata, "render_fps": round(1.0 / self.step_dt)}
        self.random = WorldRandom(self.num_envs, self.device, torch.initial_seed() if cfg.seed is None else cfg.seed)
        """Random numbers of events, noise and delays: a stream for every world."""
        report("loading kernels (new ones are compiled first)")
        self._refresh_all()
        self._init_buffers()
        report("starting managers")
        self.load_managers()
        self.event_manager.apply("startup")
        self._refresh_all()
        self.obs_buf: dict[str, Observation] = {}

    def __repr__(self) -> str:
        """Return class, task, number of worlds and device in a few words; :meth:`summary` says more."""
        task = f"{self.spec.id}, " if self.spec else ""
        return f"{type(self).__name__}({task}num_envs={self.num_envs}, device={self.device})"

    __str__ = __repr__

    def summary(self) -> str:
        """Return clocks and a table of every manager's terms, to print once before a run."""
        clocks = (
            f"{type(self).__name__}: {self.num_envs} worlds on {self.device}, "
            f"physics {self.physics_dt:.6f} s, step {self.step_dt:.4f} s"
        )
        return "\n\n".join([clocks, *(str(manager) for manager in self._managers() if manager.active_terms)])

    @property
    def num_envs(self) -> int:  # type: ignore[override]
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
    def single_observation_space(self) -> gym.spaces.Dict:  # type: ignore[override]
        """Observation of one world: a space for each group."""
        return observation_space(self.observation_manager)

    @cached_property
    def single_action_space(self) -> gym.spaces.Box:  # type: ignore[override]
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
        """Build the managers; terms may look at the managers built before them."""
        self.event_manager = EventManager(self.cfg.events, self)
        self.action_manager = ActionManager(self.cfg.actions, self)
        self.observation_manager = ObservationManager(self.cfg.observations, self)
        self.recorder_manager = RecorderManager(self.cfg.recorders, self)

    def seed(self, seed: int = -1) -> int:
        """Seed every random number generator and return the seed; a negative one draws one."""
        seed = set_seed(seed)
        if hasattr(self, "random"):
            self.random.reseed(seed)
        self._np_random, self._np_random_seed = gym.utils.seeding.np_random(seed)
        return seed

    @one_thread()
    @torch.inference_mode(False)
    @torch.no_grad()
    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, Any]]:
        """Start a new episode in every world, or in some.

        Args:
            seed: Seed to set first, of the generators that all worlds share; None for none.
            options: ``{"env_ids": indices}`` or ``{"reset_mask": one bool a world}`` resets these worlds alone: the
                others keep state and observation.

        Returns:
            Observation of each group, and extras with the logs of the episodes cut off.

        Raises:
            ValueError: If an option is unknown or malformed.
            IndexError: If a world does not exist.
            gymnasium.error.ResetNeeded: If some worlds are to be reset before all of them were.
        """
        env_ids = worlds_to_reset(options, self.num_envs, self.device)
        if env_ids is not None and not self.obs_buf:
            raise gym.error.ResetNeeded("Some worlds are to be reset, but not all have started: call reset() first.")
        if seed is not None:
            self.seed(seed)
        self.extras = {"log": {}}
        if env_ids is None:
            self._start(torch.arange(self.num_envs, device=self.device))
            self.obs_buf = self.observation_manager.compute()
        elif len(env_ids):
            self._start(env_ids, torch.isin(torch.arange(self.num_envs, device=self.device), env_ids))
            started = self.observation_manager.compute(update_history=env_ids)
            self.obs_buf = replace_worlds(self.obs_buf, started, env_ids)
        return self.obs_buf, self.extras

    @one_thread()
    @torch.inference_mode(False)
    @torch.no_grad()
    def step(self, action: torch.Tensor | np.ndarray) -> tuple[Any, ...]:
        """Advance every world by one control step.

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

    def host_ids(self, env_ids: torch.Tensor) -> torch.Tensor:
        """Return world indices on the CPU; those of the worlds that a step resets are there already.

        Args:
            env_ids: World indices, int64, shape (n,), as a reset hands them on.
        """
        if self._known_ids is not None and env_ids is self._known_ids[0]:
            return self._known_ids[1]
        return env_ids.cpu()

    def provenance(self, world: int = 0) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return what a recording of a world says about this; see :func:`arcgym.envs.provenance.provenance`."""
        return provenance(self, world)

    def episode_facts(self, world: int) -> dict[str, Any]:
        """Return what distinguishes the episode under way in a world, such as its ``patient``."""
        return episode_facts(self, world)

    def render(self) -> np.ndarray | None:  # type: ignore[override]
        """Return the picture of world ``cfg.viewer.env_id``, uint8, shape (H, W, 3); None without a render mode."""
        return None if self.render_mode is None else self.render_world(self.cfg.viewer.env_id)

    def render_world(self, env_id: int) -> np.ndarray:
        """Return the picture of one world from the view that ``cfg.viewer`` configures, uint8, shape (H, W, 3)."""
        if self._view is None:
            self._view = _class_of(self.cfg.viewer)(self, self.cfg.viewer)
        return self._view.frame(env_id)

    def close_extras(self, **kwargs: Any) -> None:
        """Write the episodes being recorded and let go of the view; called once, by :meth:`close`.

        Warns if contacts found no room, and of terms that gave what is no number.

        The simulation is freed with the environment. A GPU ends what it was given first: a process that leaves in the
        middle of a kernel may take others with it that share the GPU by MPS.
        """
        self.recorder_manager.close()
        self._view = None
        if torch.device(self.device).type == "cuda":
            torch.cuda.synchronize(self.device)
        shortage = self.sim.contact.shortage()
        if shortage is not None:
            logger.warning(shortage)
        for manager in self._managers():
            for name, count in manager.non_finite_terms().items():
                text = "%d values of the term '%s' of %s were not finite and counted as zero"
                logger.warning(text, count, name, type(manager).__name__)

    def _init_buffers(self) -> None:
        """Make what terms may read while the managers are built."""

    def _managers(self) -> list[Any]:
        return [self.event_manager, self.action_manager, self.observation_manager, self.recorder_manager]

    def _advance(self, action: torch.Tensor | np.ndarray) -> None:
        """Apply an action for a control step of physics and update the sensors."""
        self._move(action)
        self.scene.update(self.step_dt)

    def _move(self, action: torch.Tensor | np.ndarray) -> None:
        """Apply an action for a control step of physics.

        One call makes all physics steps: the simulation replays captured graphs and averages the forces over them.
        """
        if self.closed:
            raise gym.error.ClosedEnvironmentError(f"{self} is closed.")
        self.random.advance()
        self.action_manager.process_action(torch.as_tensor(action, dtype=torch.float32, device=self.device))
        self.action_manager.apply_action()
        self.recorder_manager.record_pre_step()
        self.sim.step(self.cfg.decimation)
        self.common_step_counter += 1

    def _reset_idx(self, env_ids: torch.Tensor) -> None:
        """Put worlds back to the start of an episode and collect the logs.

        Args:
            env_ids: World indices, int64, shape (n,).
        """
        self.recorder_manager.record_pre_reset(env_ids)
        self.random.begin(self.host_ids(env_ids))
        self.scene.reset(env_ids)
        self.event_manager.apply("reset", env_ids, global_env_step_count=self.common_step_counter)
        for manager in self._managers():
            self.extras["log"].update(manager.reset(env_ids))

    def _start(self, env_ids: torch.Tensor, env_mask: torch.Tensor | None = None) -> None:
        """Put worlds to the start of an episode and draw them; the mask, bool, shape (N,), names the same worlds."""
        self._reset_idx(env_ids)
        self.sim.forward(env_mask)
        self.scene.update(0.0, env_mask=env_mask)
        self.recorder_manager.record_post_reset(env_ids)

    def _refresh_all(self) -> None:
        """Recompute what follows from positions, and draw every world again."""
        self.sim.forward()
        self.scene.update(0.0)


def _class_of(cfg: Any) -> Any:
    """Return the class that a configuration names."""
    return resolve_callable(cfg.class_type) if isinstance(cfg.class_type, str) else cfg.class_type
