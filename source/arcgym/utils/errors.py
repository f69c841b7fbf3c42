# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Errors that commands answer in one line."""

from __future__ import annotations


class UsageError(ValueError):
    """A mistake of the caller that is found before any work is done.

    The message is one line that names the thing, the value given, the values expected and the nearest right name. The
    command ``arcgym`` prints it on stderr and ends with exit status 2.
    """


class TermError(UsageError):
    """A term that does not fit its manager, found when the environment is built.

    No ``TypeError``: to those ``gymnasium.make`` adds a task's whole configuration.
    """
