# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configurations of recorders and of where they write."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

from arcgym.utils import MISSING, configclass
from arcgym.utils.validation import require_at_least

if TYPE_CHECKING:
    from arcgym.managers.recorder_term import RecorderTerm


@configclass
class RecorderTermCfg:
    """Something to record; subclasses add their settings."""

    can_be_none: ClassVar[bool] = True
    """A term may be switched off with ``= None`` or ``null`` on the command line."""

    class_type: type[RecorderTerm] | str = MISSING
    """Class of the term, or its text ``"module:name"``."""


@configclass
class RecorderManagerBaseCfg:
    """Where episodes go; subclasses add terms as members."""

    dataset_export_dir_path: str = "logs/episodes"
    """Folder of the files; made where it is missing. Files in it are never overwritten."""

    dataset_filename: str = "episode"
    """Start of each file's name: ``<dataset_filename>_000000.hdf5`` and so on."""

    dataset_export_mode: Literal["all", "succeeded_only", "none"] = "all"
    """Which episodes are written: all, also those cut short by a reset or :meth:`close`; those that a termination
    term with ``success=True`` ended; or none, which records nothing."""

    env_ids: tuple[int, ...] | None = None
    """Worlds to record; None for all. Name a few when training with thousands."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_at_least(self, 0, "env_ids")
