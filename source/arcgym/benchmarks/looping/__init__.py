# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""An alpha loop of the sigmoid colon: made, measured and straightened."""
