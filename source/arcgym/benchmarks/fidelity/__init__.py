# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The physics against theory and converged references: a table with a few rows from each check."""
