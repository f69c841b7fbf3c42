# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Equations of the pages become MathML, without network and without TeX left over."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from latex2mathml.converter import convert

DOCS = Path(__file__).parents[2] / "docs"


def equations(text: str) -> list[str]:
    """TeX between single or double dollar signs, outside code."""
    text = re.sub(r"```.*?```|`[^`\n]+`", "", text, flags=re.DOTALL)
    shown = re.findall(r"\$\$(.*?)\$\$", text, re.DOTALL)
    return shown + re.findall(r"\$([^$\n]+)\$", re.sub(r"\$\$.*?\$\$", "", text, flags=re.DOTALL))


PAGES = [page for page in sorted(DOCS.glob("*.md")) if equations(page.read_text())]


def test_equations_are_found_outside_code() -> None:
    assert equations("$a$ `$b$` and $$c\nd$$\n```bash\n$e $f\n```\n") == ["c\nd", "a"]
    assert {"tasks.md", "physics.md"} <= {page.name for page in PAGES}


@pytest.mark.parametrize("page", PAGES, ids=[page.name for page in PAGES])
def test_every_equation_becomes_mathml(page: Path) -> None:
    for tex in equations(page.read_text()):
        tree = ElementTree.fromstring(convert(tex.strip()))
        assert tree.tag.endswith("math") and "\\" not in "".join(tree.itertext()), tex


def test_no_script_from_elsewhere_is_asked_for() -> None:
    conf = (DOCS / "conf.py").read_text()
    assert 'html_math_renderer = "mathml"' in conf and "mathjax" not in conf and "https://" not in conf
