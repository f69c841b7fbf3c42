# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Fixtures of the physics tests."""

from __future__ import annotations

import pytest
from tiny_sim import TinySim


@pytest.fixture(scope="session")
def tiny_sim(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    """Make simulations in the straight tube: radius 20 mm, 17 rings of 8 vertices, 12.5 mm apart."""
    return TinySim(tmp_path_factory.mktemp("tiny_sim"))
