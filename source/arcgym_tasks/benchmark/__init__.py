# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark: suites of tasks and the conditions of their trials."""
