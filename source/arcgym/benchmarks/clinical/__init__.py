# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Scripted insertions of the pushed colonoscope beside what is published of real ones."""
