# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of the simulator: speed, fidelity, long runs, camera. ``arcgym bench`` calls them."""
