# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Make a data set: episodes of an agent in one or more patients, with pictures and their truth if wanted.

    arcgym record --agent expert --task ARC-Sigmoid-Magnetic --episodes 20 --patients colon_1,colon_2 --images

--agent is expert (sees the centerline), zero, random, or a trained one: policy (PPO) or the key of another (sac, ...),
whose run --load_run and --checkpoint choose. Each patient has a folder below --out, or all one with --together; what is
there already is kept, so that the same command goes on after an interruption. README.md there tells what the data set
is. --patients takes names (colon_1), stage files, folders and splits (population:test).
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from arcgym.cli.arguments import RunArguments, add_fields, argument, positive, read_fields
from arcgym.cli.stopping import stopped_cleanly
from arcgym.cli.task import agent_names, load_cfgs, load_run_cfgs, refuse_run
from arcgym.utils.errors import UsageError
from arcgym.utils.string import did_you_mean
from arcgym.utils.untrained import UNTRAINED

TAKES_OVERRIDES = True


@dataclass(frozen=True, kw_only=True)
class RecordArguments(RunArguments):
    """Arguments of ``arcgym record``."""

    agent: str = argument("expert (default), zero, random, policy, or the key of a trained agent", "expert")
    episodes: int = argument("episodes of each patient (default: 10)", 10, type=positive)
    out: str | None = argument("folder of the data set (default: logs/datasets/<task>_<agent>)", None)
    patients: str | None = argument("colons, separated by commas (default: the task's)", None)
    together: bool = argument("simulate all patients in one batch, each episode in one that is drawn", False)
    images: bool = argument("record color, depth, normals, labels and the camera's pose", False, group="pictures")
    size: int = argument("width and height of the pictures [px] (default: 256)", 256, type=positive, group="pictures")
    samples: int = argument("rays a pixel of the color (default: 2)", 2, type=positive, group="pictures")
    observations: bool = argument("record what the policy observes too, for imitation", False)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_fields(parser, RecordArguments)


def run(namespace: argparse.Namespace) -> int:
    """Record; return 1 if a patient had to be left out.

    Raises:
        UsageError: The task, a patient, the agent or an override is wrong.
    """
    args = read_fields(RecordArguments, namespace)
    scripted = args.agent in UNTRAINED
    known = (*UNTRAINED, "policy", *agent_names(args.task))
    if len(known) > len(UNTRAINED) + 1 and args.agent not in known and not args.agent.endswith("cfg_entry_point"):
        raise UsageError(f"--agent is '{args.agent}'. {did_you_mean(args.agent, known)}")
    key = "rsl_rl_cfg_entry_point" if scripted or args.agent == "policy" else args.agent
    if scripted:
        refuse_run(args, f"with --agent {args.agent}, which has none: --agent policy is the run's own")
    asked = replace(args, agent=key)
    env_cfg, agent_cfg, checkpoint = (*load_cfgs(asked), None) if scripted else load_run_cfgs(asked)
    if args.num_envs is None:
        env_cfg.scene.num_envs = 1
    stages = _stages(env_cfg.scene.colon, args.patients)
    env_cfg.scene.colon.num_patients = None
    out = Path(args.out or f"logs/datasets/{args.task}_{args.agent}")
    return _record(args, env_cfg, agent_cfg, checkpoint, stages, out)


def _stages(colon: Any, patients: str | None) -> tuple[str, ...]:
    """Return the stage files of the patients, those of the task where none are named."""
    from arcgym.assets.patient_files import find_stages, named_colon
    from arcgym.utils.paths import resolve_asset

    try:
        if patients is None:
            return tuple(map(str, find_stages(colon.usd_path, colon.num_patients)))
        named = [named_colon(name) for name in patients.split(",")]
        stages = [[path] if resolve_asset(path).is_file() else find_stages(path) for path in named]
        return tuple(str(path) for some in stages for path in some)
    except (ValueError, OSError) as error:
        raise UsageError(str(error)) from error


def _record(
    args: RecordArguments, env_cfg: Any, agent_cfg: Any, checkpoint: Path | None, stages: tuple[str, ...], out: Path
) -> int:
    from arcgym.envs import mdp
    from arcgym.recordings.data_card import write_card
    from arcgym.recordings.generating import GenerationPlan, generate
    from arcgym.rl.device import place
    from arcgym.rl.playing import load_policy
    from arcgym.rl.preflight import check_environment
    from arcgym.utils.made_by import check_made_by

    env_cfg.scene.colon.usd_path = list(stages)
    check_environment(env_cfg, args.device, [out])
    images = mdp.PostStepImagesRecorderCfg(width=args.size, height=args.size, samples=args.samples)
    place(env_cfg, agent_cfg, args.device)
    together = args.together and len(stages) > 1
    groups = (stages,) if together else tuple((stage,) for stage in stages)
    episodes = args.episodes * len(stages) if together else args.episodes
    plan = GenerationPlan(
        args.task, episodes, out, groups, args.agent, images if args.images else None, args.observations
    )
    check_made_by(out, _made_by(args, agent_cfg.seed, checkpoint), "*/*.hdf5")
    load = None if checkpoint is None else lambda env: load_policy(env, agent_cfg, checkpoint)
    with stopped_cleanly(f"{out} holds what was done; the same command goes on"):
        report = generate(plan, env_cfg, agent_cfg, load)
    print(f"recorded: {report}")
    for line in report.skipped:
        print(f"left out: {line}")
    if report.episodes or report.found:
        agent = f"the checkpoint {checkpoint.name} of {checkpoint.parent.name}" if checkpoint else args.agent
        print(f"data card: {write_card(out, agent)}")
    return 1 if report.skipped else 0


def _made_by(args: RecordArguments, seed: int, checkpoint: Path | None) -> dict[str, Any]:
    """Return what decides an episode of the data set, beside its patient and its number."""
    from arcgym.rl.checkpoint import file_sha256

    pictures = {"size": args.size, "samples": args.samples} if args.images else None
    return {
        "task": args.task,
        "agent": args.agent,
        "checkpoint": file_sha256(checkpoint) if checkpoint else None,
        "seed": seed,
        "overrides": list(args.overrides),
        "pictures": pictures,
        "observations": args.observations,
        "together": args.together,
    }
