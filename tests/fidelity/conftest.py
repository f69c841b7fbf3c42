# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The fidelity benchmark as the tests see it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "scripts" / "benchmarks"
sys.path.insert(0, str(FOLDER))


@pytest.fixture(scope="session")
def fidelity() -> Any:
    """The script, with all checks entered."""
    import fidelity

    fidelity.load_checks()
    return fidelity


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """One run for all tests, so that they share the longer simulations."""
    from fidelity_checks.table import Run

    return Run("cpu", tmp_path_factory.mktemp("fidelity"))
