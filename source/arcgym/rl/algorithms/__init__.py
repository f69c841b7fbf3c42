# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Learning algorithms in the shape of rsl_rl's PPO: act, process_env_step, compute_returns, update, save, load."""
