# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Recordings on disk: played again and checked, made in numbers, turned into other layouts.

They are written by :class:`arcgym.managers.RecorderManager` and read by :func:`arcgym.managers.load_episodes`.
"""
