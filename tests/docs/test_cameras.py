# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The blocks of cameras.md, run in their order with the task itself, in a rigid colon."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

BLOCKS = re.findall(
    r"^```python\n(.*?)^```", (Path(__file__).parents[2] / "docs" / "cameras.md").read_text(), re.DOTALL | re.MULTILINE
)


def test_every_block_of_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page: dict = {"__name__": __name__}
    assert len(BLOCKS) == 4
    for block in BLOCKS:
        exec(
            compile(block.replace("num_envs = 2", "num_envs = 2; cfg.scene.colon.rigid = True"), "cameras.md", "exec"),
            page,
        )
    assert page["cfg"].observations.depth.depth.noise.std == 0.02
