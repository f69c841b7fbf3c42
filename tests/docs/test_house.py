# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The picture of the house shows the rooms of the table, in an order that imports allow."""

from __future__ import annotations

import re
import runpy
from pathlib import Path
from xml.etree import ElementTree

import pytest

DOCS = Path(__file__).parents[2] / "docs"
HOUSE = runpy.run_path(str(DOCS / "_ext" / "house.py"))
ROW = re.compile(r"^\| `(?:arcgym\.(?=\w+` )|(?=arcgym_))(\w+)` \|", re.MULTILINE)
TABLE = ROW.findall((DOCS / "architecture.md").read_text())
FLOORS = {name: floor for floor, rooms in enumerate(HOUSE["FLOORS"]) for name, _ in rooms}


def test_the_committed_picture_is_what_the_script_draws() -> None:
    assert (DOCS / "images" / "house.svg").read_text() == HOUSE["picture"]()
    assert ElementTree.fromstring(HOUSE["picture"]()).tag.endswith("svg")


def test_every_room_of_the_table_is_drawn_once() -> None:
    assert sorted(FLOORS) == sorted(TABLE)


@pytest.mark.parametrize(("above", "below"), list(zip(TABLE, TABLE[1:], strict=False)))
def test_rooms_further_down_the_table_stand_no_lower(above: str, below: str) -> None:
    assert FLOORS[below] <= FLOORS[above]
