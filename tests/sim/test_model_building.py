# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The scope's model has no shapes, and is otherwise the one that Newton imports."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from tiny_scope import write_tiny_scope

from arcgym.assets.endoscope_stage import read_endoscope
from arcgym.assets.usd_loading import add_endoscope_usd
from arcgym.sim.model_building import drop_shapes, empty_builder

from arcgym.utils import warp_setup  # noqa: F401  isort: skip
import newton
import warp as wp


def arrays(model: newton.Model) -> dict[str, np.ndarray]:
    """Return the arrays of a model that are not of shapes, by name."""
    found = {name: value.numpy() for name, value in vars(model).items() if isinstance(value, wp.array)}
    return {name: value for name, value in found.items() if "shape" not in name}


def test_without_shapes_links_and_joints_of_all_worlds_are_the_same(tmp_path: Path) -> None:
    path = write_tiny_scope(tmp_path / "scope.usda")
    models = []
    for bare in (False, True):
        world, builder = empty_builder(), empty_builder()
        add_endoscope_usd(world, path, read_endoscope(path))
        if bare:
            drop_shapes(world)
        builder.replicate(world, 3)
        models.append(builder.finalize(device="cpu"))
    full, bare_model = models
    assert (full.shape_count, bare_model.shape_count) == (3 * 6, 0)
    assert full.body_count == bare_model.body_count == 3 * 6
    want, have = arrays(full), arrays(bare_model)
    assert want.keys() == have.keys()
    for name, value in want.items():
        np.testing.assert_array_equal(have[name], value, err_msg=name)
