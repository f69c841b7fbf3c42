# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Policies that go on with further images."""

from __future__ import annotations

import torch
from torch import nn

from arcgym.rl.widened import widened


def test_further_channels_change_nothing_at_first():
    torch.manual_seed(0)
    old, new = nn.Conv2d(3, 4, 2), nn.Conv2d(5, 4, 2)
    new.load_state_dict(widened(old.state_dict(), new.state_dict()))
    images = torch.rand(2, 5, 6, 6)
    assert torch.allclose(new(images), old(images[:, :3]), atol=1e-6)
    assert not new.weight[:, 3:].any()


def test_what_does_not_fit_is_left_as_it_is():
    weights = {
        "fewer": torch.rand(4, 5, 2, 2),
        "outputs": torch.rand(3, 3, 2, 2),
        "matrix": torch.rand(4, 3),
        "b": torch.rand(4),
    }
    wanted = {"fewer": torch.rand(4, 3, 2, 2), "outputs": torch.rand(4, 5, 2, 2), "matrix": torch.rand(4, 5)}
    assert all(value is weights[name] for name, value in widened(weights, wanted).items())
