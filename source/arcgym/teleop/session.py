# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A world that runs in a thread of its own, steered by a hand or a policy, recorded, marked and undone."""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import torch

from arcgym.envs.memory import EnvMemory
from arcgym.rl.rollout import Policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper
from arcgym.teleop.choices import Choice, axes_of, make_cfg
from arcgym.teleop.frames import Frame, read_frame
from arcgym.teleop.hand import Hand
from arcgym.utils.errors import UsageError
from arcgym.utils.threads import one_thread

logger = logging.getLogger(__name__)

HAND = "hand"
"""Driver that is a person."""
IDLE = 0.02
"""Time between two looks at the requests while nothing moves [s]."""


@dataclass(frozen=True)
class Mark:
    """A moment to which can be gone back."""

    name: str
    """What it marks, such as the segment that begins there."""
    step: int
    """Control steps recorded before it."""
    memory: EnvMemory = field(repr=False)
    """Complete state."""


@dataclass(frozen=True)
class Status:
    """What a page says about a session."""

    choice: Choice
    """What runs."""
    state: str = "starting"
    """``running``, ``paused``, ``ended``, ``starting``, ``failed`` or ``waiting`` for a page."""
    message: str = ""
    """What happened last."""
    driver: str = HAND
    """Who chooses the actions."""
    steps: int = 0
    """Control steps of the recording under way."""
    marks: tuple[str, ...] = ()
    """Names of the marks, the oldest first."""
    rate: float = 0.0
    """Control steps a second, over the last ten."""
    interventions: int = 0
    """How often a hand took over from a policy."""
    undone: int = 0
    """How often was gone back to a mark."""


class Session:
    """Runs one world, or the first of many; everything asked of it is done between two steps.

    Pages read :attr:`status` and :attr:`frame`. Other worlds do what the policy chosen last does, or stand still.
    """

    def __init__(
        self, choice: Choice, out: Path, drivers: Mapping[str, Callable[[RslRlVecEnvWrapper], Policy]]
    ) -> None:
        """Prepare; :meth:`start` begins.

        Args:
            choice: What to run first.
            out: Folder of the recordings.
            drivers: Makers of policies by name.
        """
        self.out, self.drivers = out, dict(drivers)
        self.status = Status(choice)
        self.frame: Frame | None = None
        self.hand = Hand(())
        self.speed = 1.0
        """Simulated seconds a second that are aimed at."""
        self.needs_page = True
        """Whether nothing moves while no page shows a sign of life."""
        self.starts_paused = True
        """Whether an episode waits for somebody to let it go; otherwise the next one follows each that ends."""
        self.env: Any = None
        self.building = threading.Lock()
        """Held while an environment is built: nothing may be drawn meanwhile."""
        self.frames = 0
        """Frames made so far, in all environments."""
        self.generation = 0
        """Counts the environments."""
        self._requests: queue.Queue[tuple[Callable[[], Any], Future[Any]]] = queue.Queue()
        self._stop = threading.Event()
        self.thread = threading.Thread(target=self._run, name="arcgym-session", daemon=True)
        """Where the world is stepped."""
        self._paused, self._single, self._has_ended = True, False, False
        self._marks: list[Mark] = []
        self._times: deque[float] = deque(maxlen=11)
        self._due = 0.0
        self._policy: Policy | None = None

    def start(self) -> None:
        """Build the environment and run, in a thread of its own."""
        self.thread.start()

    def close(self) -> None:
        """Save what is under way and end."""
        self._stop.set()
        self.thread.join()

    def ask(self, do: Callable[[], Any]) -> Future[Any]:
        """Have a function called between two steps, in the session's thread; its result comes in the future."""
        future: Future[Any] = Future()
        self._requests.put((do, future))
        return future

    # What can be asked for: each returns a future, for those who wait.

    def pause(self, paused: bool) -> Future[Any]:
        """Stop, or go on."""
        return self.ask(lambda: self._pause(paused))

    def single_step(self) -> Future[Any]:
        """Make one control step and stop."""
        return self.ask(self._single_step)

    def give(self, driver: str) -> Future[Any]:
        """Let a policy, or the hand, choose the actions."""
        return self.ask(lambda: self._give(driver))

    def mark(self, name: str = "") -> Future[Any]:
        """Mark this moment."""
        return self.ask(lambda: self._mark(name))

    def undo(self, index: int = -1) -> Future[Any]:
        """Go back to a mark; those after it are forgotten."""
        return self.ask(lambda: self._undo(index))

    def save(self) -> Future[Any]:
        """Finish the recording's file, and begin another from here; the result is its path."""
        return self.ask(self._save)

    def start_anew(self, keep: bool = True) -> Future[Any]:
        """Begin an episode; what was recorded is saved, or dropped."""
        return self.ask(lambda: self._start_anew(keep))

    def load(self, choice: Choice) -> Future[Any]:
        """Run something else; what was recorded is saved."""
        return self.ask(lambda: self._load(choice))

    def _run(self) -> None:
        try:
            self._try(lambda: self._load(self.status.choice), Future())
            while not self._stop.is_set():
                self._answer()
                if self._may_step():
                    self._try(self._step, Future())
                    self._keep_pace()
                else:
                    self._times.clear()
                    time.sleep(IDLE)
        finally:
            self._close_env()

    def _answer(self) -> None:
        while not self._requests.empty():
            self._try(*self._requests.get())

    def _try(self, do: Callable[[], Any], future: Future[Any]) -> None:
        """Do something; an error is told and leaves the session as it is, paused."""
        try:
            future.set_result(do())
        except Exception as error:  # noqa: BLE001 - whatever it is, the session goes on and says so
            if not isinstance(error, UsageError):
                logger.exception("teleoperation")
            self._paused = True
            self._say(f"{type(error).__name__}: {error}", state="failed" if self.env is None else "paused")
            future.set_exception(error)

    def _may_step(self) -> bool:
        """Return whether the world goes on now."""
        if self.env is None:
            return False
        return self._single or self._update_state() == "running"

    def _update_state(self) -> str:
        """Tell and return whether the world is paused, waiting for a page or running; a hand that is gone lets go."""
        waits = self.needs_page and not self.hand.is_alive
        state = "paused" if self._paused else "waiting" if waits else "running"
        if self.status.state not in (state, "ended") or (self.status.state == "ended" and state == "running"):
            self._say(state=state)
        if waits:
            self.hand.release()
        return state

    @one_thread()
    @torch.inference_mode(False)
    @torch.no_grad()
    def _step(self) -> None:
        self._single = False
        commanded = self.hand.value()
        if commanded.any() and self.status.driver != HAND:
            self._say("a hand has taken over", driver=HAND, interventions=self.status.interventions + 1)
        action = self._actions()
        if self.status.driver == HAND:
            action[0] = torch.as_tensor(commanded, device=self.env.device)
        self.env.hand_leads.fill_(self.status.driver == HAND)
        self.env.step(action)
        self._look()
        if bool(self.env.reset_buf[0]) and self.status.state != "ended" and not self._has_ended:
            self._end()

    def _actions(self) -> torch.Tensor:
        """Return what the policy chosen last does in all worlds, and nothing where there is none."""
        if self._policy is None or (self.status.driver == HAND and self.env.num_envs == 1):
            return torch.zeros(self.env.num_envs, self.env.action_manager.total_action_dim, device=self.env.device)
        return self._policy(self._wrapped.pack(self.env.obs_buf)).clone()

    def _end(self) -> None:
        """Stop where the episode ends; one may go on nevertheless."""
        if not self.starts_paused:
            return self._start_anew()
        judge = self.env.termination_manager
        by = [name for name in judge.active_terms if bool(judge.get_term(name)[0])]
        self._paused = self._has_ended = True
        what = "reached the goal" if bool(self.env.succeeded[0]) else f"ended by {', '.join(by) or 'a broken state'}"
        self._say(f"{what}: save, undo, start anew, or go on", state="ended")

    def _look(self) -> None:
        """Copy the world for the pages, and count."""
        self._times.append(time.perf_counter())
        self.frames += 1
        self.frame = read_frame(self.env, 0, 0 if self.frame is None else self.frame.number + 1)
        spent = self._times[-1] - self._times[0]
        rate = (len(self._times) - 1) / spent if spent > 0.0 else 0.0
        self.status = replace(self.status, steps=self.env.recorder_manager.length(0), rate=rate)

    def _keep_pace(self) -> None:
        """Wait until the next step is due; time that was lost is not caught up."""
        now = time.perf_counter()
        period = self.env.step_dt / max(self.speed, 0.01) if self.env is not None else 0.0
        self._due = max(self._due + period, now)
        if self._due - now > period:
            self._due = now + period
        time.sleep(max(self._due - now, 0.0))

    def _pause(self, paused: bool) -> None:
        self._paused = paused
        self._say(state="paused" if paused else "running")

    def _single_step(self) -> None:
        self._paused = self._single = True
        self._say(state="paused")

    def _give(self, driver: str) -> None:
        if driver != HAND:
            if driver not in self.drivers:
                raise UsageError(f"There is no driver '{driver}'; there are {', '.join([HAND, *self.drivers])}.")
            self._policy = self.drivers[driver](self._wrapped)
        self._say(f"{driver} drives", driver=driver)

    def _mark(self, name: str) -> str:
        length = self.env.recorder_manager.length(0)
        segment = self.frame.info.segment if self.frame else ""
        mark = Mark(name or f"{segment} {length * self.env.step_dt:.1f} s", length, EnvMemory(self.env))
        self._marks.append(mark)
        self._tell_marks(f"marked: {mark.name}")
        return mark.name

    def _undo(self, index: int) -> str:
        mark = self._marks[index]
        mark.memory.restore()
        self.env.recorder_manager.shorten(0, mark.step)
        self._marks = self._marks[: self._marks.index(mark) + 1]
        self._forget_policy()
        self.hand.release()
        self._paused, self._has_ended = True, False
        self._tell_marks(f"back at: {mark.name}", undone=self.status.undone + 1, state="paused")
        self._look()
        return mark.name

    def _save(self) -> Path:
        recorder, world = self.env.recorder_manager, torch.zeros(1, dtype=torch.long, device=self.env.device)
        if not recorder.length(0):
            raise UsageError("There is nothing to save: no step was made since the last file.")
        recorder.record_pre_reset(world)
        recorder.record_post_reset(world)
        self._begin()
        self._say(f"saved: {recorder.paths[-1]}")
        return recorder.paths[-1]

    def _start_anew(self, keep: bool = True) -> None:
        if not keep:
            self.env.recorder_manager.ignore([0])
            self.env.recorder_manager.ignore([])
        before = self.env.recorder_manager.num_exported
        self.env.reset()
        self._forget_policy()
        self._paused, self._has_ended = self.starts_paused, False
        self._begin()
        saved = self.env.recorder_manager.paths[before:]
        self._say(f"saved: {saved[-1]}" if saved else "ready", state="paused")

    def _begin(self) -> None:
        """Begin a recording here, with a first mark."""
        self._marks = []
        self.status = replace(self.status, interventions=0, undone=0)
        self._look()
        self._mark("start")

    def _load(self, choice: Choice) -> None:
        name, cfg = make_cfg(choice, self.out)
        with self.building:
            self._say(f"building {choice.task}", state="starting")
            self._close_env()
            env: Any = gym.make(name, cfg=cfg).unwrapped
            env.hand_leads = torch.zeros(env.num_envs, dtype=torch.uint8, device=env.device)
            env.hand_marks = []
            self._wrapped, self._policy = RslRlVecEnvWrapper(env), None
            env.cfg.autoreset = False
            env.step(torch.zeros(env.num_envs, env.action_manager.total_action_dim))  # captures the graph
            env.recorder_manager.ignore([0])
            env.recorder_manager.ignore([])
            self.env = env
            names, _ = axes_of(env)
            strength = self.hand.strength
            self.hand = Hand(names)
            self.hand.strength = strength
            self.frame = None
            self.generation += 1
        self.status = replace(self.status, choice=choice, driver=HAND)
        self._start_anew()
        if choice.driver != HAND:
            self._give(choice.driver)

    def _close_env(self) -> None:
        if self.env is not None:
            self.env.close()
            self.env = None

    def _forget_policy(self) -> None:
        policy: Any = self._policy
        if hasattr(policy, "reset"):
            policy.reset(torch.ones(self.env.num_envs, dtype=torch.bool, device=self.env.device))

    def _tell_marks(self, message: str, **changes: Any) -> None:
        marks = [{"name": mark.name, "step": mark.step} for mark in self._marks]
        self._say(message, marks=tuple(mark.name for mark in self._marks), **changes)
        self.env.recorder_manager.notes = {"marks": marks, "undone": self.status.undone}
        self.env.hand_marks = [(mark.step, mark.memory.worlds) for mark in self._marks]

    def _say(self, message: str | None = None, **changes: Any) -> None:
        if message is not None:
            changes["message"] = message
        self.status = replace(self.status, **changes)
        if self.env is not None and "interventions" in changes:
            notes = self.env.recorder_manager.notes
            self.env.recorder_manager.notes = {**notes, "interventions": self.status.interventions}
