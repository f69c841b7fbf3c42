# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Populations of patients by name. Loads nothing: packages may register theirs where they register tasks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from arcgym.utils.string import did_you_mean, resolve_callable

Resolver = Callable[[str, int | None], Sequence[Path]]
"""Returns the stages of the first so many patients of a split, of all for None, and makes those that are missing."""

POPULATIONS: dict[str, str | Resolver] = {"population": "arcgym.anatomy.generator.stored_patients:population_stages"}
"""Resolvers by the name of their population."""


def register_population(name: str, resolver: str | Resolver) -> None:
    """Let ``name:split`` stand for stages, in ``env.scene.colon.usd_path``.

    Args:
        name: Name before the colon, of at least two letters.
        resolver: Function of a split's name and a number of patients, see :data:`Resolver`, or its name
            ``"module:function"``, which is imported when stages are asked for. It raises :class:`ValueError` or
            :class:`KeyError` for a split that it does not have.

    Raises:
        ValueError: If the name is taken or too short.
    """
    if name in POPULATIONS or len(name) < 2:
        raise ValueError(f"A population cannot be called {name!r}: it is taken or shorter than two letters.")
    POPULATIONS[name] = resolver


def population_stages(name: str, split: str, count: int | None) -> Sequence[Path]:
    """Return the stages of a population's split.

    Args:
        name: Name of the population.
        split: Name of the split.
        count: Number of patients, from the first; None for all.

    Raises:
        ValueError: If there is no such population or split.
    """
    if name not in POPULATIONS:
        raise ValueError(f"There is no population {name!r} ({name}:{split}). {did_you_mean(name, POPULATIONS)}")
    found = POPULATIONS[name]
    resolver = resolve_callable(found) if isinstance(found, str) else found
    try:
        return resolver(split, count)
    except KeyError as error:
        raise ValueError(f"Population {name!r} has no split {split!r}: its resolver found no {error}.") from error
