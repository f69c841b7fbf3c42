# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Base of all managers."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import torch

from arcgym.managers.term_base import ManagerTermBase
from arcgym.managers.term_cfg import ManagerTermBaseCfg
from arcgym.managers.term_resolver import collect_terms, resolve_term
from arcgym.utils.errors import TermError
from arcgym.utils.string import did_you_mean, resolve_matching_names
from arcgym.utils.worlds import finite

if TYPE_CHECKING:
    from arcgym.envs import ManagerBasedEnv


class ManagerBase:
    """Holds named terms and evaluates them.

    A manager without terms does nothing and answers with neutral values: environments need not ask.
    """

    term_cfg_type: ClassVar[type] = ManagerTermBaseCfg
    """Class that each configured term must have."""

    leading_arguments: ClassVar[tuple[str, ...]] = ("env",)
    """Positional arguments that a term function takes before its parameters."""

    unit: ClassVar[str] = "terms"
    """Word for what the table counts."""

    def __init__(self, cfg: Any, env: ManagerBasedEnv) -> None:
        """Copy the configuration and resolve its terms.

        Args:
            cfg: Configuration instance or dict whose members are terms; None for no terms.
            env: Environment the manager belongs to.

        Raises:
            TermError: If a member is not a term of this manager, or a signature does not fit its parameters.
            ValueError: If a name does not exist.
        """
        self.cfg = copy.deepcopy(cfg)
        self._env = env
        self._non_finite: torch.Tensor | None = None
        self._terms = self._prepare_terms()

    def __str__(self) -> str:
        """List the terms."""
        return format_table(f"{type(self).__name__} ({len(self._terms)} {self.unit})", self._columns(), self._rows())

    @property
    def num_envs(self) -> int:
        """Number of worlds N."""
        return self._env.num_envs

    @property
    def device(self) -> str:
        """Device of all tensors."""
        return self._env.device

    @property
    def active_terms(self) -> list[str]:
        """Names of the terms, in order."""
        return list(self._terms)

    def find_terms(self, patterns: str | list[str]) -> list[str]:
        """Return the names of the terms that regular expressions match."""
        return resolve_matching_names(patterns, self.active_terms)[1]

    def get_term_cfg(self, name: str) -> Any:
        """Return the resolved configuration of a term; changes to it take effect at once.

        Raises:
            ValueError: If there is no such term, with those there are.
        """
        if name not in self._terms:
            raise ValueError(f"{type(self).__name__} has no term '{name}'. {did_you_mean(name, self._terms)}")
        return self._terms[name]

    def set_term_cfg(self, name: str, cfg: Any) -> None:
        """Replace a term by another configuration, which is resolved here."""
        self.get_term_cfg(name)
        collect_terms({name: cfg}, self.term_cfg_type, type(self).__name__)
        self._terms[name] = copy.deepcopy(cfg)
        self._resolve(name, self._terms[name])

    def reset(self, env_ids: torch.Tensor | None = None) -> dict[str, Any]:
        """Forget the past of some worlds.

        Args:
            env_ids: World indices, int64, shape (n,); None for all.

        Returns:
            Values to log about the episodes that ended.
        """
        for term in self._terms.values():
            if isinstance(term.func, ManagerTermBase):
                term.func.reset(env_ids)
        return {}

    def _prepare_terms(self) -> dict[str, Any]:
        terms = collect_terms(self.cfg, self.term_cfg_type, type(self).__name__)
        for name, term in terms.items():
            self._resolve(name, term)
        return terms

    def _resolve(self, name: str, term: Any) -> None:
        resolve_term(term, self._env, name, type(self).__name__, self.leading_arguments)

    def _evaluate(self, name: str) -> torch.Tensor:
        term = self._terms[name]
        try:
            return term.func(self._env, **term.params)
        except Exception as error:
            error.add_note(f"in the term '{name}' of {type(self).__name__}")
            raise

    def non_finite_terms(self) -> dict[str, int]:
        """Return how many values of a term were not finite in worlds whose state was; terms without any are left out.

        They counted as zero: a wrong term gives a wrong sum. Waits for the device.
        """
        if self._non_finite is None:
            return {}
        return {name: count for name, count in zip(self._value_names, self._non_finite.tolist(), strict=True) if count}

    def _finite_rows(self, values: Sequence[torch.Tensor]) -> torch.Tensor:
        """Return the values of the terms, shape (N,) each, as rows (T, N); what is not finite is zero, and counted."""
        rows = torch.stack([value.float() for value in values])
        kept = finite(rows)
        broken = ((rows != kept) & ~self._env.sim.non_finite).sum(dim=1)
        self._non_finite = broken if self._non_finite is None else self._non_finite + broken
        return kept

    @property
    def _value_names(self) -> list[str]:
        """Names of the terms in the order of :meth:`_finite_rows`."""
        return list(self._terms)

    def _check_values(self, dtype: torch.dtype | None = None) -> None:
        """Evaluate every term once to check shape and type, then let them forget it.

        Raises:
            TermError: If a value is no tensor or of another dtype.
            ValueError: If a value does not hold one entry a world, or one that is not finite.
        """
        for name in self._terms:
            value = self._evaluate(name)
            label = f"Term '{name}' of {type(self).__name__}"
            if not isinstance(value, torch.Tensor):
                raise TermError(f"{label} returned {type(value).__name__}, expected a tensor.")
            if value.shape != (self.num_envs,):
                raise ValueError(f"{label} returned shape {tuple(value.shape)}, expected ({self.num_envs},).")
            if not bool(torch.isfinite(value).all()):
                raise ValueError(f"{label} returned {value.tolist()[:4]} at the start, expected finite numbers.")
            if dtype is not None and value.dtype != dtype:
                raise TermError(f"{label} returned {value.dtype}, expected {dtype}.")
        ManagerBase.reset(self)

    def _columns(self) -> list[str]:
        """Headings of the table that lists the terms."""
        return ["index", "name"]

    def _rows(self) -> list[list[Any]]:
        """Cells of the table that lists the terms."""
        return [[index, name] for index, name in enumerate(self._terms)]


def format_table(title: str, columns: list[str], rows: list[list[Any]]) -> str:
    """Return a table in plain text with a title and a line of headings; the title alone if there are no rows."""
    if not rows:
        return title
    cells = [columns] + [[str(cell) for cell in row] for row in rows]
    widths = [max(len(row[column]) for row in cells) for column in range(len(columns))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in cells]
    return "\n  ".join([title, lines[0], "  ".join("-" * width for width in widths), *lines[1:]])
