# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Studies: grids of algorithms, tasks, robots and seeds, cell by cell, and what is made of them."""
