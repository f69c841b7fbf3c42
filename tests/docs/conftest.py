# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The page extend.md as a module, and the environment of the configuration that it leaves behind."""

from __future__ import annotations

import importlib.util
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
import torch
from tiny import write_tiny_colon

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="session")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """The page's blocks as one module, imported in a folder that has ``my_colon/colon.usda``.

    ``extended.env`` was stepped once; its rollout length and images are the tasks' own, its two worlds a short tube.
    """
    from arcgym.envs import ManagerBasedRLEnv

    folder = tmp_path_factory.mktemp("extend")
    (folder / "my_colon").mkdir()
    write_tiny_colon(folder / "my_colon", length=0.3)
    code = "\n\n".join(re.findall(r"^```python\n(.*?)^```", (DOCS / "extend.md").read_text(), re.DOTALL | re.MULTILINE))
    (folder / "extend_page.py").write_text(code)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        page = _load(folder / "extend_page.py")
        page.cfg.scene.colon.rigid = True
        page.env = ManagerBasedRLEnv(page.cfg, render_mode="rgb_array")
        page.env.reset(seed=0)
        page.obs, page.reward, _, _, page.extras = page.env.step(torch.ones(2, 1))
        yield page
        page.env.close()


def _load(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module
