# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""A writer of curves that survives a full disk."""

from __future__ import annotations

from typing import Any


class PatientWriter:
    """Passes everything on to a TensorBoard writer; after an error of the disk it says so once and writes no more."""

    def __init__(self, writer: Any):
        """Wrap ``writer``."""
        self._writer = writer
        self._has_failed = False

    def __getattr__(self, name: str) -> Any:
        """Return what the writer itself has."""
        return getattr(self._writer, name)

    def add_scalar(self, *args: Any, **kwargs: Any) -> None:
        """Add a point to a curve."""
        if self._has_failed:
            return
        try:
            self._writer.add_scalar(*args, **kwargs)
        except OSError as error:
            self._has_failed = True
            reason = error.strerror or error
            print(f"curves are no longer written to {self._writer.log_dir}: {reason}; training goes on", flush=True)
