# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How fast a task runs: steps per second, memory and the time of each part of a control step."""
