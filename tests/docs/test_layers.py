# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The picture of the layers shows the packages of the table, in an order that imports allow."""

from __future__ import annotations

import re
import runpy
from pathlib import Path
from xml.etree import ElementTree

import pytest

DOCS = Path(__file__).parents[2] / "docs"
SCRIPT = runpy.run_path(str(DOCS / "_ext" / "layers.py"))
ROW = re.compile(r"^\| `(?:arcgym\.(?=\w+` )|(?=arcgym_))(\w+)` \|", re.MULTILINE)
TABLE = ROW.findall((DOCS / "architecture.md").read_text())
LAYERS = {name: layer for layer, packages in enumerate(SCRIPT["LAYERS"]) for name, _ in packages}


def test_the_committed_picture_is_what_the_script_draws() -> None:
    assert (DOCS / "images" / "layers.svg").read_text() == SCRIPT["picture"]()
    assert ElementTree.fromstring(SCRIPT["picture"]()).tag.endswith("svg")


def test_every_package_of_the_table_is_drawn_once() -> None:
    assert sorted(LAYERS) == sorted(TABLE)


@pytest.mark.parametrize(("above", "below"), list(zip(TABLE, TABLE[1:], strict=False)))
def test_packages_further_down_the_table_stand_no_lower(above: str, below: str) -> None:
    assert LAYERS[below] <= LAYERS[above]
