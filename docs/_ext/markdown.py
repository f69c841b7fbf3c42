# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table; bars and line breaks within cells are made harmless."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(_cell(entry) for entry in line) + " |" for line in lines) + "\n"


def code(text: object) -> str:
    """Return text as code; empty for nothing."""
    return f"`{text}`" if str(text) else ""


def plain(text: str) -> str:
    """Return a docstring's reStructuredText as Markdown: roles become code, double backquotes single ones."""
    text = re.sub(r":\w+(?::\w+)?:`~?([^`<]*?)(?:\s*<[^`]*>)?`", r"`\1`", text)
    return re.sub(r"``(.+?)``", r"`\1`", text).replace("<", "&lt;") if "`" not in text else _outside_code(text)


def _outside_code(text: str) -> str:
    parts = re.split(r"(``.+?``|`.+?`)", text)
    return "".join(f"`{part.strip('`')}`" if i % 2 else part.replace("<", "&lt;") for i, part in enumerate(parts))


def _cell(entry: object) -> str:
    return " ".join(str(entry).split()).replace("|", "\\|")
