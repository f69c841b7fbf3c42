# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Train a policy with rsl_rl.

    python scripts/rsl_rl/train.py --task ARC-Splenic-Proximal --num_envs 64 --max_iterations 300

The run goes to ``logs/rsl_rl/<experiment>/<time>[_<run name>]``. Ctrl-C or a kill leaves a checkpoint there; go on with
``--resume``.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

from arcgym.rl import cli


def main() -> None:
    """Parse the arguments and train."""
    parser = cli.make_parser("Train a policy with rsl_rl.")
    parser.add_argument("--max_iterations", type=int, help="updates to run, on top of those of a resumed run")
    parser.add_argument("--run_name", help="suffix of the run's folder")
    parser.add_argument("--resume", action="store_true", help="go on from a checkpoint (--load_run, --checkpoint)")
    parser.add_argument("--logger", choices=("tensorboard", "wandb", "neptune"), help="where curves go")
    parser.add_argument("--log_project_name", help="project for wandb and neptune")
    parser.add_argument("--distributed", action="store_true", help="one process a GPU, started by torchrun")
    cli.add_run_arguments(parser)
    cli.add_video_arguments(parser)
    parser.add_argument("--video_interval", type=int, default=2000, help="control steps between videos (default: 2000)")
    args, overrides = cli.parse(parser)
    env_cfg, agent_cfg = cli.load_cfgs(parser, args, overrides)
    train(args, env_cfg, agent_cfg)


def train(args: argparse.Namespace, env_cfg: Any, agent_cfg: Any) -> None:
    """Build environment and runner, learn, and say where the results are."""
    from arcgym.rl import TrainingInterrupted, create_run_folder, find_checkpoint, write_params

    checkpoint = None
    if agent_cfg.resume:
        checkpoint = find_checkpoint(agent_cfg.experiment_name, agent_cfg.load_run, agent_cfg.load_checkpoint)
    device = cli.place(env_cfg, agent_cfg, args.device, args.distributed)
    folder = create_run_folder(agent_cfg.experiment_name, agent_cfg.run_name)
    env_cfg.log_dir = str(folder)
    write_params(folder, env=env_cfg, agent=agent_cfg)
    env = make_env(args, env_cfg, agent_cfg, folder)
    runner = make_runner(env, agent_cfg, folder, device)
    if checkpoint is not None:
        runner.load(str(checkpoint))
        print(f"resumed from {checkpoint} at iteration {runner.current_learning_iteration}")
    try:
        runner.learn(agent_cfg.max_iterations, agent_cfg.init_at_random_ep_len)
    except TrainingInterrupted as interrupt:
        print(f"stopped by {interrupt}; go on with: --resume --load_run {folder.name}")
        sys.exit(128 + interrupt.signal_number)
    finally:
        env.close()
        print(f"run: {folder}")
    print(f"checkpoint: {folder / f'model_{runner.current_learning_iteration}.pt'}")


def make_env(args: argparse.Namespace, env_cfg: Any, agent_cfg: Any, folder: Path) -> Any:
    """Build the environment as rsl_rl sees it."""
    import gymnasium as gym

    from arcgym.rl import PeriodicVideo, RslRlVecEnvWrapper

    print(f"building {env_cfg.scene.num_envs} worlds on {env_cfg.sim.device}; compiling kernels (first run only)")
    start = time.perf_counter()
    env: gym.Env = gym.make(args.task, cfg=env_cfg, render_mode="rgb_array" if args.video else None)
    if args.video:
        from arcgym.viewers import VideoRecorder

        fps = round(1.0 / env.unwrapped.step_dt)  # type: ignore[attr-defined]
        env = PeriodicVideo(
            env,
            folder / "videos" / "train",
            lambda path: VideoRecorder(path, fps),
            length=args.video_length,
            interval=args.video_interval,
        )
    wrapped = RslRlVecEnvWrapper(env, clip_actions=agent_cfg.clip_actions)
    print(f"ready after {time.perf_counter() - start:.1f} s")
    return wrapped


def make_runner(env: Any, agent_cfg: Any, folder: Path, device: str) -> Any:
    """Say how much memory the rollout takes and build the runner that the agent's configuration names."""
    from rsl_rl.utils import resolve_callable

    from arcgym.rl import describe_rollout

    print(describe_rollout(env.get_observations(), env.num_actions, agent_cfg.num_steps_per_env))
    runner_class = resolve_callable(agent_cfg.class_name)
    return runner_class(env, agent_cfg.to_dict(), log_dir=str(folder), device=device)


if __name__ == "__main__":
    main()
