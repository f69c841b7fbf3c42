# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Task configurations of ARCGym; importing this package registers them with Gymnasium and loads nothing heavy."""

from __future__ import annotations

from arcgym_tasks import navigation  # noqa: F401
