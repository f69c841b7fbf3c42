# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

import pytest
import torch
from tensordict import TensorDict
from torch import nn

from arcgym.evaluation.batched_policy import BatchedPolicy


class Counting(nn.Module):
    """Adds up what it has seen of each world of its batch, and notes the batch's size."""

    def __init__(self) -> None:
        super().__init__()
        self.total = torch.zeros(4, 1)
        self.layer = nn.Linear(1, 1)

    def forward(self, obs: TensorDict) -> torch.Tensor:
        assert obs.batch_size[0] == 4
        self.total = self.total + obs["policy"]
        return self.total

    def reset(self, dones: torch.Tensor) -> None:
        self.total = torch.where(dones.bool()[:, None], 0.0, self.total)


def observation(count: int) -> TensorDict:
    return TensorDict({"policy": torch.arange(1.0, count + 1)[:, None]}, batch_size=[count])


@pytest.mark.parametrize("count", [1, 4, 6])
def test_every_world_is_remembered_on_its_own(count: int) -> None:
    policy = BatchedPolicy(Counting(), count, batch=4)
    policy(observation(count))
    dones = torch.zeros(count, dtype=torch.long)
    dones[0] = 1
    policy.reset(dones)
    assert policy(observation(count)).flatten().tolist() == [1.0, *(2.0 * k for k in range(2, count + 1))]


def test_an_answer_does_not_depend_on_the_number_of_worlds() -> None:
    torch.manual_seed(0)
    network = nn.Sequential(nn.Conv2d(3, 8, 3), nn.ReLU(), nn.Flatten(), nn.Linear(8 * 18 * 18, 5))
    images = torch.rand(40, 3, 20, 20)
    answers = []
    for count in (1, 6, 40):
        policy = BatchedPolicy(lambda obs: network(obs["policy"]), count)
        answers.append(policy(TensorDict({"policy": images[:count]}, batch_size=[count]))[0])
    assert answers[0].equal(answers[1]) and answers[0].equal(answers[2])
