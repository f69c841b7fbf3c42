# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The page of terms: what each manager can call, with parameters, units and defaults."""

from __future__ import annotations

from markdown import code, plain, table

from arcgym.envs import mdp
from arcgym.utils.reference import TermReference, terms_of

KINDS = ("observation", "reward", "cost", "termination", "metrics", "event", "curriculum")
"""Sections of the page; a term stands in the first that it serves and names the others."""


def page() -> str:
    """Return the page."""
    terms = terms_of(mdp)
    parts = [
        "# Terms\n",
        "Made from the code. All are in `arcgym.envs.mdp`; a term stands under the first manager that it serves. Units "
        "and shapes, with N worlds, are in the descriptions. *Checked* names what a value may be; any other is "
        "refused before anything is built.\n",
    ]
    for kind in KINDS:
        parts.append(f"## Terms of the {kind} manager\n")
        parts += [_term(term) for term in terms if _home(term) == kind]
    return "\n".join(parts)


def _home(term: TermReference) -> str:
    return next(kind for kind in KINDS if kind in term.kinds)


def _term(term: TermReference) -> str:
    others = [kind for kind in term.kinds if kind != _home(term)]
    also = f" Serves {', '.join(others)} too." if others else ""
    rows = [(code(p.name), code(p.default), plain(p.description), plain(p.expected)) for p in term.params]
    params = table(("Parameter", "Default", "Description", "Checked"), rows) if rows else "No parameters.\n"
    return f"### {code(term.name)}\n\n{plain(term.summary)}{also}\n\n{params}"
