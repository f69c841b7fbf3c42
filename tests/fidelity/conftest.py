# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The fidelity benchmark as the tests see it."""

from __future__ import annotations

import pytest

from arcgym.benchmarks.fidelity.rows import Run


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """One run for all tests, so that they share the longer simulations."""
    return Run("cpu", tmp_path_factory.mktemp("fidelity"))
