# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""One session of the soak: a task under adversarial actions until its budget is spent."""

from __future__ import annotations

import gc
import statistics
import time
from dataclasses import dataclass
from typing import Any

import torch

from arcgym.benchmarks.hardware import device_mib, host_mib
from arcgym.benchmarks.soak.adversaries import Adversaries
from arcgym.benchmarks.soak.isolation import breakage_caught, neighbors_disturbed
from arcgym.benchmarks.soak.journal import Journal, Tally
from arcgym.benchmarks.soak.watch import Watch
from arcgym.benchmarks.worlds import forward_axis, make_env

READ_EVERY = 20
"""Control steps between two readings of the counters, which wait for the device."""


@dataclass
class Budget:
    """Control steps and time that a session of one task may take."""

    env_steps: int
    """Control steps, over all worlds."""
    deadline: float
    """When it has to end, by ``time.monotonic`` [s]."""

    def spent(self, env_steps: int) -> bool:
        """Return whether so many control steps are enough, or time is up."""
        return env_steps >= self.env_steps or time.monotonic() >= self.deadline


def soak(task: str, env_cfg: Any, budget: Budget, journal: Journal) -> None:
    """Run one session of a task: checks, then adversarial steps until the budget is spent, then checks again."""
    env_cfg.seed += journal.sessions(task)
    journal.write("start", task, seed=env_cfg.seed, num_envs=env_cfg.scene.num_envs, device=env_cfg.sim.device)
    env = make_env(task, env_cfg)
    adversaries = Adversaries(
        env.num_envs,
        env.action_manager.total_action_dim,
        forward_axis(env),
        env.step_dt,
        env.device,
        env_cfg.seed,
    )
    check_worlds(env, adversaries, journal, task)
    watch = Watch(env, adversaries.kind)
    with watch.guard.watch():
        step_on(env, adversaries, watch, budget, journal, task)
    check_worlds(env, adversaries, journal, task)
    env.close()
    gc.collect()


def step_on(env: Any, adversaries: Adversaries, watch: Watch, budget: Budget, journal: Journal, task: str) -> None:
    """Step the worlds and write what is found, until the budget is spent."""
    force, restarted = idle(env)
    memory: list[tuple[float, float]] = []
    done, start = 0, time.monotonic()
    while not budget.spent(done):
        for _ in range(READ_EVERY):
            obs, reward, terminated, truncated, extras = env.step(adversaries.act(force, restarted))
            watch.look(obs, reward, terminated, extras)
            force = env.scene["endoscope"].data.window_force_peak.amax(dim=1)
            restarted = terminated | truncated
        now = time.monotonic()
        tally, events = watch.read(now - start)
        start, done = now, done + tally.env_steps
        memory.append((host_mib(), device_mib(env.device) or 0.0))
        for event in events:
            journal.write("event", task, seed=env.cfg.seed, **event)
        journal.write_part(task, tally)
        progress(task, journal.tally(task), tally, memory[-1])
    host, device = (growth([sample[k] for sample in memory]) for k in (0, 1))
    journal.write_part(task, Tally(host_growth_mib=host, device_growth_mib=device))


def idle(env: Any) -> tuple[torch.Tensor, torch.Tensor]:
    """Return force and restarts before the first step: none."""
    return torch.zeros(env.num_envs, device=env.device), torch.zeros(env.num_envs, dtype=torch.bool, device=env.device)


def growth(samples: list[float]) -> float:
    """Return the median of the last quarter of the samples less that of the second, 0 until there are eight."""
    quarter = len(samples) // 4
    if quarter < 2:
        return 0.0
    return statistics.median(samples[-quarter:]) - statistics.median(samples[quarter : 2 * quarter])


def check_worlds(env: Any, adversaries: Adversaries, journal: Journal, task: str) -> None:
    """Check that a broken world is caught and that a reset leaves the others alone; write what is wrong."""
    problems = [f"after a NaN in world 0: {problem}" for problem in breakage_caught(env)]
    disturbed = neighbors_disturbed(env, adversaries.act(*idle(env)))
    if disturbed:
        problems.append(f"a reset of world 0 changed the next step of {disturbed} other worlds")
    if problems:
        journal.write_part(task, Tally(problems=problems))


def progress(task: str, total: Tally, part: Tally, memory: tuple[float, float]) -> None:
    """Print one line on the state of things."""
    forces = max(total.largest["shaft_force"].values())
    print(
        f"{task:24s}{total.env_steps:>10d} steps {part.env_steps / part.seconds:>8.1f}/s  {total.resets} resets  "
        f"{total.recovered_worlds} recovered  {total.pierced} pierced, {total.pierced_lightly} lightly  "
        f"{total.outside_links} links outside  "
        f"{total.missed_contacts} missed and {total.dropped_contacts} dropped contacts  "
        f"{sum(total.not_finite.values())} not finite  up to {forces:.1f} N  "
        f"host {memory[0]:.0f} MiB  device {memory[1]:.0f} MiB",
        flush=True,
    )
