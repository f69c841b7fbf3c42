# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A policy shown at work: figures, video, trajectories, exported files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.rl.checkpoint import read_checkpoint
from arcgym.rl.device import place
from arcgym.rl.exporter import export_policy_as_jit, export_policy_as_onnx
from arcgym.rl.make_env import VideoOptions, make_env
from arcgym.rl.preflight import check_environment, check_run
from arcgym.rl.pretrained import is_pretrained
from arcgym.rl.rollout import UNTRAINED_POLICIES, Policy, RolloutResult, run_policy
from arcgym.rl.run_folder import LOG_ROOT
from arcgym.rl.trained_policy import trained_policy
from arcgym.rl.vecenv_wrapper import RslRlVecEnvWrapper
from arcgym.utils.progress import counted


@dataclass(frozen=True)
class PlayOptions:
    """Settings of :func:`play` that are no part of the configurations."""

    policy: str = "trained"
    """``trained``, or a key of :data:`arcgym.rl.rollout.UNTRAINED_POLICIES`."""

    checkpoint: Path | None = None
    """Checkpoint of a trained policy."""

    device: str | None = None
    """``cpu``, ``cuda`` or ``cuda:<n>``; None takes the first GPU, or the CPU where there is none."""

    steps: int | None = None
    """Control steps; None ends when each world's first episode has ended."""

    video_length: int | None = None
    """Control steps of a video; None records none."""

    record: str | None = None
    """Folder for trajectories, or a file ending in ``.hdf5``; None records none."""

    json: bool = False
    """Whether the figures are printed as JSON on the last line."""

    observations: bool = False
    """Whether the group ``policy`` is recorded too, as imitation needs it."""


def play(task: str, env_cfg: Any, agent_cfg: Any, options: PlayOptions = PlayOptions()) -> RolloutResult:
    """Check everything, build the environment, run the policy, and say how it did and where the files are.

    Raises:
        UsageError: Something is wrong that can be known before the run.
    """
    folder = output_folder(agent_cfg.experiment_name, options.checkpoint, options.policy)
    _check(env_cfg, agent_cfg, options, folder)
    place(env_cfg, agent_cfg, options.device)
    records = _record_to(options, env_cfg)
    video = VideoOptions(folder.resolve() / "videos" / "play", options.video_length) if options.video_length else None
    env = make_env(task, env_cfg, agent_cfg, video)
    try:
        print(env.unwrapped.summary())
        if options.checkpoint:
            policy = load_policy(env, agent_cfg, options.checkpoint)
        else:
            policy = UNTRAINED_POLICIES[options.policy](env)
        with counted("playing", options.steps or int(env.max_episode_length)) as show:
            result = run_policy(env, policy, options.steps, show)
        print(result)
    finally:
        env.close()
        for path in getattr(env.env, "paths", []) if video else []:
            print(f"video: {path}")
        if records and options.record and records.is_dir():
            print(f"recorded: {_finish_records(options.record, records)}")
    if options.json:
        print(result.to_json())
    return result


def output_folder(experiment: str, checkpoint: Path | None, policy: str = "trained") -> Path:
    """Return where videos and exported files go: beside the checkpoint, but never among what ARCGym came with."""
    if checkpoint is None:
        return LOG_ROOT / experiment / policy
    return LOG_ROOT / experiment / "pretrained" if is_pretrained(checkpoint) else checkpoint.parent


def load_policy(env: RslRlVecEnvWrapper, agent_cfg: Any, checkpoint: Path) -> Policy:
    """Return the trained policy, exported into ``exported`` of its :func:`output_folder`."""
    policy = trained_policy(env, agent_cfg, checkpoint)
    print(f"checkpoint: {checkpoint}")
    for export in (export_policy_as_jit, export_policy_as_onnx):
        print(f"exported: {export(policy, output_folder(agent_cfg.experiment_name, checkpoint) / 'exported')}")
    return policy


def _check(env_cfg: Any, agent_cfg: Any, options: PlayOptions, folder: Path) -> None:
    """Raise where the run cannot end well."""
    outputs = [folder] if options.checkpoint or options.video_length else []
    if options.record:
        outputs.append(Path(options.record))
    if options.checkpoint:
        check_run(env_cfg, agent_cfg, options.device, outputs)
        read_checkpoint(options.checkpoint)
    else:
        check_environment(env_cfg, options.device, outputs)


def _record_to(options: PlayOptions, env_cfg: Any) -> Path | None:
    """Switch recording on where it is asked for, and return the folder of the episodes."""
    record = options.record
    if not record:
        return None
    from arcgym.envs import mdp

    path = Path(record).resolve()
    folder = path.with_suffix("") if path.suffix == ".hdf5" else path
    env_cfg.recorders = env_cfg.recorders or mdp.TrajectoryRecorderCfg()
    env_cfg.recorders.dataset_export_dir_path = str(folder)
    if options.observations:
        env_cfg.recorders.observations = mdp.PreStepObservationsRecorderCfg()
    return folder


def _finish_records(record: str, folder: Path) -> str:
    """Copy the episodes into one file where it is asked for, and say where they are."""
    from arcgym.managers import episode_paths, export_hdf5

    count = len(episode_paths(folder))
    if record.endswith(".hdf5"):
        count = export_hdf5(folder, record)
    return f"{count} episodes in {record}"
