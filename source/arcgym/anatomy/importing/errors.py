# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Errors of an import."""

from __future__ import annotations


class ColonImportError(ValueError):
    """The input cannot become a colon; the message says what was found and what to pass."""

    def __init__(self, found: str, mend: str) -> None:
        """Join what was found and what the caller can do about it."""
        super().__init__(f"{found.rstrip('.')}. {mend}")


class ImportArgumentError(ColonImportError):
    """A setting or a path cannot be right; raised before any file is read."""
