# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of the paper that benchmarks stand beside."""

PAPER_RATE = {1: 12.22, 5: 34.65}
"""Control steps per second over all worlds, by number of worlds, in the table of throughput of "ARCGym: Benchmarking
Deep Reinforcement Learning in Autonomous Robotic Colonoscopy" (RA-L 2026); measured there on an RTX PRO 6000."""
PAPER_TRANSITIONS = 44_000
"""Control steps of a run in that table, over all worlds."""
CONTROL_DT = 1.0 / 120.0
"""Control step of the paper [s]."""
EPISODE_S = 40.0
"""Episode of the paper [s]."""
