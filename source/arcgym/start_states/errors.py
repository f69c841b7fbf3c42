# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What goes wrong with start states."""

from __future__ import annotations

from arcgym.utils.errors import UsageError


class StartStateError(UsageError):
    """A start state is missing and could not be made; the message says how far the expert came."""
