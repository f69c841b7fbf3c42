# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What the soak does to the worlds and what it looks at; ``scripts/benchmarks/soak.py`` runs it."""
