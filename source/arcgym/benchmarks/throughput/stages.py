# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Where the time of a control step goes: every part of the loop, timed alone from the same state."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any
from unittest.mock import patch

import torch
import warp as wp

from arcgym.benchmarks.timing import Action, median_ms
from arcgym.envs.mdp import lumen_scores
from arcgym.utils.threads import one_thread

RESET_SHARE = 0.05
"""Fraction of the worlds that the timed reset starts again; at least one."""

STAGES = {
    "physics": "all physics steps of a control step",
    "contact": "  contact search",
    "scope": "  scope substeps with link forces and drives",
    "wall": "  wall step",
    "wall_coarse": "    of it the coarse correction, with prediction",
    "wall_sweep": "    of it the sweeps, with prediction",
    "camera": "surface, ray tree and pictures of all worlds",
    "camera_draw": "  of it drawing",
    "managers": "the rest of env.step",
    "action": "  action manager",
    "termination": "  termination manager",
    "reward": "  reward manager",
    "cost": "  cost manager",
    "metrics": "  metrics manager",
    "event": "  interval events",
    "observation": "  observation manager",
    "reset": f"reset of {RESET_SHARE:.0%} of the worlds, at least one",
    "reset_events": "  of it events and managers",
}
"""What each stage is; an indented one is part of the one above it. The stages of the wall solver are there with
``solver="two_level"`` alone."""


@one_thread()
@torch.no_grad()
def time_stages(env: Any, actions: torch.Tensor, repeats: int) -> dict[str, float]:
    """Return the median duration of every stage, in milliseconds a control step.

    Each call starts from the state that the environment is in now, so that the scope touches the wall as it does in the
    loop.

    Args:
        env: A reset :class:`ManagerBasedRLEnv`, whose state is put back between the stages.
        actions: Actions of all worlds, shape (N, A).
        repeats: Timed calls of each stage.
    """
    restore = state_keeper(env.sim)
    stages = {**physics_stages(env), **camera_stages(env), **manager_stages(env, actions), **reset_stages(env)}
    return {name: median_ms(stage, env.device, repeats, restore) for name, stage in stages.items()}


def state_keeper(sim: Any) -> Action:
    """Return a function that puts the simulation back into its present state."""
    kept = {name: array.clone() for name, array in sim.world_arrays().items()}

    def restore() -> None:
        for name, array in sim.world_arrays().items():
            array.copy_(kept[name])
        sim.forward()

    return restore


def physics_stages(env: Any) -> dict[str, Action]:
    """Return the physics of a control step, and its parts as often as they occur in it.

    Contact search and wall step are called with the arguments that the coupling gives them; the scope is the rest of
    the coupling, whatever solver it has.
    """
    sim, steps = env.sim, env.cfg.decimation
    stages: dict[str, Action] = {"physics": lambda: sim.step(steps)}
    if sim.cfg.solver != "two_level":
        return stages
    contact, wall = sim.contact, sim.wall
    move_wall = recorded_call(sim, wall, "step")
    stages["contact"] = repeated(sim, lambda: contact.detect(sim.nodal_pos, sim.state.body_q), steps)
    searches = [(contact, name) for name in ("follow", "find", "order")]
    with silenced(*searches, *[(wall, name) for name in ("prepare", "begin_contacts", "step")]):
        stages["scope"] = repeated(sim, sim.coupling.step, steps)
    stages["wall"] = repeated(sim, move_wall, steps)
    for name, field, off in (("wall_coarse", "iterations", 0), ("wall_sweep", "coarse_correction", False)):
        if hasattr(sim.wall.cfg, field):
            with patch.object(sim.wall.cfg, field, off):
                stages[name] = repeated(sim, move_wall, steps)
    return stages


def recorded_call(sim: Any, part: Any, method: str) -> Action:
    """Make a physics step and return the method's first call in it, to be made again."""
    original, calls = getattr(part, method), []

    def record(*args: Any, **kwargs: Any) -> None:
        calls.append((args, kwargs))
        original(*args, **kwargs)

    with patch.object(part, method, record):
        sim.coupling.step()
    args, kwargs = calls[0]
    return lambda: original(*args, **kwargs)


def repeated(sim: Any, action: Action, count: int) -> Action:
    """Return ``action`` done ``count`` times, replayed from a graph as the simulation does it."""
    action()
    with wp.ScopedCapture(device=sim.device) as capture:
        action()
    graph = capture.graph

    def replay() -> None:
        for _ in range(count):
            wp.capture_launch(graph)

    return replay


def camera_stages(env: Any) -> dict[str, Action]:
    """Return the camera update of all worlds, uncaptured as in the loop, and the drawing alone."""
    if "camera" not in env.scene.sensors:
        return {}
    camera = env.scene["camera"]
    return {"camera": camera.update, "camera_draw": camera.draw}


def manager_stages(env: Any, actions: torch.Tensor) -> dict[str, Action]:
    """Return the rest of ``env.step`` without physics, camera and resets, and each manager alone."""

    def rest() -> None:
        silent = silenced((env.sim, "step"), (env.sim, "forward"), (env, "_reset_idx"))
        with silent, patch.object(env.scene, "update", lambda *args, **kwargs: new_frame(env)):
            env.step(actions)

    def act() -> None:
        env.action_manager.process_action(actions)
        env.action_manager.apply_action()

    dt = env.step_dt if env.cfg.scale_rewards_by_dt else 1.0
    return {
        "managers": rest,
        "action": act,
        "termination": env.termination_manager.compute,
        "reward": lambda: env.reward_manager.compute(dt),
        "cost": lambda: env.cost_manager.compute(dt),
        "metrics": env.metrics_manager.compute,
        "event": lambda: env.event_manager.apply("interval", dt=env.step_dt),
        "observation": env.observation_manager.compute,
    }


def new_frame(env: Any) -> None:
    """Make the terms score the camera's images as if they were new."""
    if "camera" in env.scene.sensors:
        env.scene["camera"].data.frame += 1


def reset_stages(env: Any) -> dict[str, Action]:
    """Return the reset of a share of the worlds, with and without redrawing and scoring their pictures."""
    count = max(1, round(RESET_SHARE * env.num_envs))
    env_ids = torch.randperm(env.num_envs, device=env.device)[:count]
    mask = torch.zeros(env.num_envs, dtype=torch.bool, device=env.device)
    mask[env_ids] = True

    def reset() -> None:
        env._reset_idx(env_ids)
        env.sim.forward()
        env.scene.update(0.0, env_mask=mask)
        if hasattr(env.cfg, "lumen") and "camera" in env.scene.sensors:
            lumen_scores(env)

    return {"reset": reset, "reset_events": lambda: env._reset_idx(env_ids)}


@contextmanager
def silenced(*methods: tuple[object, str]) -> Iterator[None]:
    """Make the named methods of objects do nothing for a while."""
    with ExitStack() as stack:
        for owner, name in methods:
            stack.enter_context(patch.object(owner, name, lambda *args, **kwargs: None))
        yield
