# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Run a trained policy, record it and export it.

    python scripts/rsl_rl/play.py --task ARC-Splenic-Proximal --video --record logs/episodes

Uses the ``-Play`` variant of the task. The video goes to ``videos/play`` of the run, the policy to ``exported``.
``--policy zero`` and ``--policy random`` need no checkpoint. ``--record`` writes every episode's trajectory to a file.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from arcgym.rl import cli
from arcgym.utils.registry import list_tasks


def main() -> None:
    """Parse the arguments and play."""
    parser = cli.make_parser("Run a trained policy, record it and export it.")
    parser.add_argument("--policy", choices=("trained", "zero", "random"), default="trained", help="what acts")
    parser.add_argument("--steps", type=int, help="control steps (default: the video's, else one episode)")
    parser.add_argument("--record", metavar="PATH", help="record trajectories: a folder, or a file ending in .hdf5")
    parser.add_argument("--json", action="store_true", help="print the figures as JSON on the last line")
    cli.add_run_arguments(parser)
    cli.add_video_arguments(parser)
    args, overrides = cli.parse(parser)
    if f"{args.task}-Play" in list_tasks(prefix=""):
        args.task = f"{args.task}-Play"
    env_cfg, agent_cfg = cli.load_cfgs(parser, args, overrides)
    play(args, env_cfg, agent_cfg)


def play(args: argparse.Namespace, env_cfg: Any, agent_cfg: Any) -> None:
    """Build the environment, run the policy, and say how it did and where the files are."""
    from arcgym.rl.rollout import run_policy

    checkpoint = find_policy(args, agent_cfg)
    folder = checkpoint.parent if checkpoint else Path("logs/rsl_rl") / agent_cfg.experiment_name / args.policy
    device = cli.place(env_cfg, agent_cfg, args.device)
    records = record_to(args, env_cfg)
    env, videos = make_env(args, env_cfg, agent_cfg, folder.resolve())
    policy = make_policy(args, env, agent_cfg, checkpoint, device)
    steps = args.steps or (args.video_length if args.video else int(env.max_episode_length))
    try:
        result = run_policy(env, policy, steps)
        print(result)
    finally:
        env.close()
    for path in videos:
        print(f"video: {path}")
    if records:
        print(f"recorded: {finish_records(args, records)}")
    if args.json:
        print(result.to_json())


def find_policy(args: argparse.Namespace, agent_cfg: Any) -> Path | None:
    """Return the checkpoint to load, or None for a policy that needs none."""
    from arcgym.rl import find_checkpoint

    if args.policy != "trained":
        return None
    return find_checkpoint(agent_cfg.experiment_name, agent_cfg.load_run, agent_cfg.load_checkpoint)


def make_env(args: argparse.Namespace, env_cfg: Any, agent_cfg: Any, folder: Path) -> tuple[Any, list[Path]]:
    """Return the environment as rsl_rl sees it, and the list that its videos' paths go to."""
    import gymnasium as gym

    from arcgym.rl import PeriodicVideo, RslRlVecEnvWrapper

    print(f"building {env_cfg.scene.num_envs} worlds on {env_cfg.sim.device}; compiling kernels (first run only)")
    env: gym.Env = gym.make(args.task, cfg=env_cfg, render_mode="rgb_array" if args.video else None)
    videos: list[Path] = []
    if args.video:
        from arcgym.viewers import VideoRecorder

        fps = round(1.0 / env.unwrapped.step_dt)  # type: ignore[attr-defined]
        length = args.video_length
        env = recorder = PeriodicVideo(
            env, folder / "videos" / "play", lambda path: VideoRecorder(path, fps), length=length, interval=10**9
        )
        videos = recorder.paths
    return RslRlVecEnvWrapper(env, clip_actions=agent_cfg.clip_actions), videos


def record_to(args: argparse.Namespace, env_cfg: Any) -> Path | None:
    """Switch recording on where the command line asks for it, and return the folder of the episodes."""
    if not args.record:
        return None
    from arcgym.envs import mdp

    path = Path(args.record).resolve()
    folder = path.with_suffix("") if path.suffix == ".hdf5" else path
    env_cfg.recorders = env_cfg.recorders or mdp.TrajectoryRecorderCfg()
    env_cfg.recorders.dataset_export_dir_path = str(folder)
    return folder


def finish_records(args: argparse.Namespace, folder: Path) -> str:
    """Copy the episodes into one file where the command line asks for it, and say where they are."""
    from arcgym.managers import episode_paths, export_hdf5

    count = len(episode_paths(folder))
    if args.record.endswith(".hdf5"):
        count = export_hdf5(folder, args.record, {"env_name": args.task, "type": "arcgym"})
    return f"{count} episodes in {args.record}"


def make_policy(args: argparse.Namespace, env: Any, agent_cfg: Any, checkpoint: Path | None, device: str) -> Any:
    """Return the policy that acts; a trained one is exported beside its checkpoint."""
    from rsl_rl.utils import resolve_callable

    from arcgym.rl import export_policy_as_jit, export_policy_as_onnx
    from arcgym.rl.rollout import random_policy, zero_policy

    if checkpoint is None:
        return zero_policy(env) if args.policy == "zero" else random_policy(env)
    runner = resolve_callable(agent_cfg.class_name)(env, agent_cfg.to_dict(), log_dir=None, device=device)
    runner.load(str(checkpoint), load_cfg={"actor": True})
    policy = runner.get_inference_policy(device)
    print(f"checkpoint: {checkpoint}")
    for export in (export_policy_as_jit, export_policy_as_onnx):
        print(f"exported: {export(policy, checkpoint.parent / 'exported')}")
    return policy


if __name__ == "__main__":
    main()
