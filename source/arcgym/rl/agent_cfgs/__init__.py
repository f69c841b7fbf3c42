# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configurations of the agents beyond PPO, one module an algorithm. Importing them loads neither torch nor rsl_rl."""
