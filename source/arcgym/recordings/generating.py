# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Data sets: episodes of an agent in one or more patients, recorded until there are as many as wanted."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch

from arcgym.envs import mdp
from arcgym.managers import count_episodes, episode_paths
from arcgym.managers.recorder_files import PARTIAL, open_recording
from arcgym.rl.make_env import make_env
from arcgym.rl.rollout import UNTRAINED_POLICIES, Policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper
from arcgym.utils.errors import UsageError


@dataclass(frozen=True)
class GenerationPlan:
    """What is to be recorded."""

    task: str
    """Registered name."""

    episodes: int
    """Episodes of each group."""

    out: Path
    """Folder of the data set; each group has one below it."""

    groups: tuple[tuple[str, ...], ...]
    """Stages of colons that are simulated together. A group of several draws a world's patient at every reset."""

    agent: str = "expert"
    """A key of :data:`arcgym.rl.rollout.UNTRAINED_POLICIES`, or ``policy``."""

    images: mdp.PostStepImagesRecorderCfg | None = None
    """Pictures to record; None for none."""

    observations: bool = False
    """Whether the policy's observations are recorded too, as imitation needs them."""


@dataclass
class GenerationReport:
    """What was done, in this run alone."""

    episodes: int = 0
    """Episodes written."""

    steps: int = 0
    """Control steps written."""

    seconds: float = 0.0
    """Time taken without building environments [s]."""

    simulated: float = 0.0
    """Simulated time written [s]."""

    found: int = 0
    """Episodes that were there before."""

    skipped: list[str] = field(default_factory=list)
    """Groups for which no environment could be built, with the reason."""

    def __str__(self) -> str:
        """Return the figures in one line."""
        before = f", {self.found} were there" if self.found else ""
        if not self.episodes:
            return f"nothing to do{before}"
        return (
            f"{self.episodes} episodes of {self.steps} steps in {self.seconds:.1f} s{before}: "
            f"{self.steps / self.seconds:.1f} steps per s, {self.simulated / self.seconds:.2f} simulated s per s"
        )


def generate(
    plan: GenerationPlan,
    env_cfg: Any,
    agent_cfg: Any,
    load_policy: Callable[[RslRlVecEnvWrapper], Policy] | None = None,
    say: Callable[[str], None] = print,
) -> GenerationReport:
    """Record what the data set lacks, group by group.

    Every round records each world's first episode and no other: of worlds that start again at once, short episodes
    would be recorded more often. Worlds of a round share a seed, which the next round counts up.

    Args:
        plan: What is to be recorded.
        env_cfg: Configuration of the environment; its colon is replaced.
        agent_cfg: Configuration of the agent, for its seed and the bound of its actions.
        load_policy: Makes the policy where the plan's agent is ``policy``.
        say: Called with a line of text after every round.
    """
    report = GenerationReport()
    for group in plan.groups:
        folder = plan.out / group_name(group)
        found = clean(folder)
        report.found += found
        if found >= plan.episodes:
            continue
        cfg = copy.deepcopy(env_cfg)
        cfg.scene.colon.usd_path = group[0] if len(group) == 1 else list(group)
        cfg.scene.num_envs = min(cfg.scene.num_envs, plan.episodes - found)
        cfg.recorders = recorders_of(plan, folder)
        try:
            env = make_env(plan.task, cfg, agent_cfg)
        except (ValueError, OSError) as error:
            report.skipped.append(f"{group_name(group)}: {error}")
            continue
        try:
            policy = load_policy(env) if load_policy else UNTRAINED_POLICIES[plan.agent](env)
            _fill(env, policy, plan.episodes, found, report, say)
        finally:
            env.close()
    return report


def recorders_of(plan: GenerationPlan, folder: Path) -> Any:
    """Return the recorders of a patient's episodes."""
    cfg = mdp.TrajectoryRecorderCfg(dataset_export_dir_path=str(folder))
    cfg.images = plan.images
    if plan.observations:
        cfg.observations = mdp.PreStepObservationsRecorderCfg()
    return cfg


def group_name(group: tuple[str, ...]) -> str:
    """Return the name of a group's folder: ``colon_1`` of ``colon_1/colon.usda``, ``together`` of several."""
    path = Path(group[0])
    return "together" if len(group) > 1 else path.parent.name or path.stem


def clean(folder: Path) -> int:
    """Remove what an interrupted run left unfinished, and return the number of whole episodes."""
    for path in folder.glob(f"*{PARTIAL}"):
        path.unlink()
    whole = 0
    for path in episode_paths(folder):
        with open_recording(path) as file:
            complete = '"complete": true' in file["data/demo_0"].attrs["info"]
        if complete:
            whole += count_episodes(path)
        else:
            path.unlink()
    return whole


def _fill(
    env: RslRlVecEnvWrapper,
    policy: Policy,
    wanted: int,
    found: int,
    report: GenerationReport,
    say: Callable[[str], None],
) -> None:
    """Record rounds until a group has as many episodes as wanted."""
    seed = env.unwrapped.cfg.seed or 0
    while found < wanted:
        start = time.perf_counter()
        env.unwrapped.cfg.seed = seed + found
        episodes, steps = _round(env, policy, wanted - found, seed + found)
        if not episodes:
            raise UsageError("A round of episodes ended without one of them: nothing was recorded.")
        report.seconds += time.perf_counter() - start
        report.episodes += episodes
        report.steps += steps
        report.simulated += steps * env.unwrapped.step_dt
        found += episodes
        folder = Path(env.unwrapped.cfg.recorders.dataset_export_dir_path).name
        say(f"{folder}: {found} of {wanted} episodes; so far {report}")


def _round(env: RslRlVecEnvWrapper, policy: Policy, wanted: int, seed: int) -> tuple[int, int]:
    """Record the first episode of each world, of ``wanted`` worlds at most; return episodes and steps."""
    recorder = env.unwrapped.recorder_manager
    recorder.ignore(range(env.num_envs))
    env.unwrapped.seed(seed)
    recorder.ignore(range(wanted, env.num_envs))
    obs, _ = env.reset()
    before, steps = recorder.num_exported, 0
    done = torch.zeros(env.num_envs, dtype=torch.bool, device=env.device)
    done[wanted:] = True
    if hasattr(policy, "reset"):
        policy.reset(torch.ones_like(done))
    with torch.inference_mode():
        while not bool(done.all()):
            steps += int((~done).sum())
            obs, _, dones, _ = env.step(policy(obs))
            if hasattr(policy, "reset"):
                policy.reset(dones)
            if bool((dones > 0).any()):
                done |= dones > 0
                recorder.ignore(done.nonzero().flatten().tolist())
    return recorder.num_exported - before, steps
