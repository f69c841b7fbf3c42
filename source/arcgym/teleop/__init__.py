# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A window into a running world, and a hand on it, in the browser.

:mod:`session` steps the world, :mod:`hand` holds what people command, :mod:`looker` draws, :mod:`page` is what the
browser shows, :mod:`gate` lets nobody in without the token.
"""
