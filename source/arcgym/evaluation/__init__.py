# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluation of agents: trials from condition files, a row a trial, statistics, tables and a page."""
