# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Long runs under random, extreme and adversarial actions, and the search for what must not happen."""
