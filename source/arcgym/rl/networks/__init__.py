# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Networks beyond rsl_rl's: augmented, recurrent, and those of soft actor-critic."""
