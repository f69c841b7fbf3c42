# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Policies that go on with further images, vectors or a memory."""

from __future__ import annotations

import torch
from torch import nn

from arcgym.rl.widened import widened, with_memory, with_vectors


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


def test_a_memory_gets_columns_of_zeros_behind_those_of_the_features():
    weights = {"mlp.0.weight": torch.tensor([[1.0, 2.0], [3.0, 4.0]]), "mlp.0.bias": torch.ones(2)}
    wanted = {"mlp.0.weight": torch.rand(2, 3), "mlp.0.bias": torch.zeros(2), "rnn.rnn.bias_hh_l0": torch.rand(3)}
    got = with_memory(weights, wanted, width=1)
    assert got["mlp.0.weight"].tolist() == [[1.0, 2.0, 0.0], [3.0, 4.0, 0.0]]
    assert got["mlp.0.bias"] is weights["mlp.0.bias"] and got["rnn.rnn.bias_hh_l0"] is wanted["rnn.rnn.bias_hh_l0"]


def test_a_memory_is_added_where_the_rest_fits_and_none_is_there():
    wanted = {"mlp.0.weight": torch.rand(2, 3), "rnn.rnn.bias_hh_l0": torch.rand(3)}
    for weights in ({"mlp.0.weight": torch.rand(2, 1)}, {"mlp.0.weight": torch.rand(1, 2)}, {"b": torch.rand(2)}):
        assert with_memory(weights, wanted, width=1) is weights
    remembering = {"mlp.0.weight": torch.rand(2, 2), "rnn.rnn.bias_hh_l0": torch.rand(3)}
    assert with_memory(remembering, wanted, width=1) is remembering


def test_vectors_get_columns_of_zeros_in_front_of_those_of_the_features():
    weights = {"mlp.0.weight": torch.tensor([[1.0, 2.0], [3.0, 4.0]]), "mlp.0.bias": torch.ones(2)}
    wanted = {"mlp.0.weight": torch.rand(2, 3), "mlp.0.bias": torch.zeros(2), "obs_normalizer._mean": torch.rand(1, 1)}
    got = with_vectors(weights, wanted, width=1)
    assert got["mlp.0.weight"].tolist() == [[0.0, 1.0, 2.0], [0.0, 3.0, 4.0]]
    assert got["mlp.0.bias"] is weights["mlp.0.bias"]
    assert got["obs_normalizer._mean"] is wanted["obs_normalizer._mean"]


def test_vectors_are_added_where_the_rest_fits_and_none_are_there():
    wanted = {"mlp.0.weight": torch.rand(2, 3)}
    for weights in ({"mlp.0.weight": torch.rand(2, 3)}, {"mlp.0.weight": torch.rand(1, 2)}, {"b": torch.rand(2)}):
        assert with_vectors(weights, wanted, width=1) is weights
    same = {"mlp.0.weight": torch.rand(2, 3)}
    assert with_vectors(same, wanted, width=0) is same
