# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Run a task with raw actions that are zero, to see that it works and what a policy has to beat."""

from __future__ import annotations

from arcgym.rl import cli


def main() -> None:
    """Parse the arguments and run."""
    parser = cli.make_parser("Run a task with raw actions that are zero.")
    parser.add_argument("--steps", type=int, default=100, help="control steps (default: 100)")
    parser.add_argument("--json", action="store_true", help="print the figures as JSON on the last line")
    args, overrides = cli.parse(parser)
    env_cfg, agent_cfg = cli.load_cfgs(parser, args, overrides)
    cli.place(env_cfg, agent_cfg, args.device)

    import gymnasium as gym

    from arcgym.rl import RslRlVecEnvWrapper
    from arcgym.rl.rollout import run_policy, zero_policy

    env = RslRlVecEnvWrapper(gym.make(args.task, cfg=env_cfg))
    result = run_policy(env, zero_policy(env), args.steps)
    print(result)
    if args.json:
        print(result.to_json())
    env.close()


if __name__ == "__main__":
    main()
