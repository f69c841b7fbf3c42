# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Fields of an environment that an evaluation sets itself, so that an override of them would do nothing."""

from __future__ import annotations

import re
from collections.abc import Sequence

from arcgym.utils.errors import UsageError

SET_BY_TRIALS = {
    "seed": "give other trials by --conditions",
    "log_dir": "give --out",
    "recorders": "record with arcgym play --record",
    "curriculum": "trials have none",
    "sim.device": "give --device",
    "scene.num_envs": "give --num_envs",
    "scene.colon.usd_path": "give trials on these patients by --conditions",
    "scene.colon.num_patients": "give --num_patients",
}
"""What to do instead, by the path of a field; all fields below it are meant too."""


def is_set_by_trials(path: str) -> bool:
    """Return whether an evaluation sets a field itself; ``path`` is its dotted path below the environment."""
    return _field_above(path) is not None


def refuse_what_trials_set(overrides: Sequence[str]) -> None:
    """Refuse overrides that trials would take no notice of.

    Args:
        overrides: Texts ``env.path=value``.

    Raises:
        UsageError: One is of a field that an evaluation sets itself.
    """
    for text in overrides:
        path, _, value = text.lstrip("+").partition("=")
        field = _set_by(path.removeprefix("env."), value) if path.startswith("env.") else None
        if field is not None:
            raise UsageError(
                f"{text} would change nothing, as trials set env.{field} themselves: {SET_BY_TRIALS[field]}."
            )


def _set_by(path: str, value: str) -> str | None:
    """Return the entry of :data:`SET_BY_TRIALS` that an override gives, alone or in a group such as ``{seed: 1}``."""
    below = [field for field in SET_BY_TRIALS if field.startswith(f"{path}.")]
    inside = (field for field in below if re.search(rf"\b{field.rpartition('.')[2]}\b['\"]?\s*:", value))
    return _field_above(path) or next(inside, None)


def _field_above(path: str) -> str | None:
    """Return the entry of :data:`SET_BY_TRIALS` that a path is or lies below."""
    return next((field for field in SET_BY_TRIALS if path == field or path.startswith(f"{field}.")), None)
