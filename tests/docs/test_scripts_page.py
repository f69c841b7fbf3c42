# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/README.md names every script, and no other."""

from __future__ import annotations

import re
from pathlib import Path

SCRIPTS = Path(__file__).parents[2] / "scripts"


def test_every_script_is_on_the_page() -> None:
    named = {Path(name).name for name in re.findall(r"`([\w/]+\.py)`", (SCRIPTS / "README.md").read_text())}
    assert named == {path.name for path in SCRIPTS.rglob("*.py")}
