# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

import numpy as np
import pytest
import torch

from arcgym.utils.world_random import WorldRandom, episode_seeds


@pytest.fixture
def random() -> WorldRandom:
    """Four worlds on the CPU."""
    return WorldRandom(4, "cpu", seed=3)


def test_numbers_follow_from_the_seed_alone(random: WorldRandom) -> None:
    again = WorldRandom(4, "cpu", seed=3)
    other = WorldRandom(4, "cpu", seed=4)
    assert random.uniform("light", 5).equal(again.uniform("light", 5))
    assert not random.uniform("light", 5).equal(other.uniform("light", 5))


def test_nothing_is_used_up(random: WorldRandom) -> None:
    assert random.uniform("light").equal(random.uniform("light"))


def test_tags_steps_and_worlds_differ(random: WorldRandom) -> None:
    drawn = [random.uniform("light", 2), random.uniform("color", 2)]
    random.advance()
    drawn.append(random.uniform("light", 2))
    assert len(torch.cat(drawn).flatten().unique()) == 24


def test_a_world_does_not_see_the_others(random: WorldRandom) -> None:
    alone = random.uniform("light", 3, env_ids=torch.tensor([2]))
    assert alone.equal(random.uniform("light", 3)[2:3])
    random.begin(torch.tensor([0, 1, 3]))
    assert alone.equal(random.uniform("light", 3)[2:3])


def test_the_same_episode_seed_gives_the_same_numbers_in_every_world() -> None:
    drawn = []
    for num_envs, world in ((1, 0), (6, 4)):
        random = WorldRandom(num_envs, "cpu", seed=num_envs)
        random.seed_source = lambda ids: torch.full((len(ids),), 77)
        random.begin(torch.tensor([world]))
        random.advance()
        drawn.append(random.normal("tip", 3, env_ids=torch.tensor([world])))
    assert drawn[0].equal(drawn[1])


def test_every_episode_of_every_world_has_a_seed_of_its_own(random: WorldRandom) -> None:
    seeds = set(random.episode_seed.tolist())
    for _ in range(2):
        random.begin(torch.arange(4))
        seeds |= set(random.episode_seed.tolist())
    assert len(seeds) == 12


def test_reseeding_starts_all_over(random: WorldRandom) -> None:
    first = random.episode_seed.clone()
    random.begin(torch.arange(4))
    random.reseed(3)
    assert random.episode_seed.equal(first)


def test_uniform_numbers_are_spread_evenly(random: WorldRandom) -> None:
    counts = torch.histc(random.uniform("spread", 25_000), bins=10, min=0.0, max=1.0)
    assert counts.sum() == 100_000
    assert (counts - 10_000).abs().max() < 400  # four standard deviations, sqrt(100 000 x 0.1 x 0.9) = 95


def test_normal_numbers_have_mean_zero_and_deviation_one(random: WorldRandom) -> None:
    drawn = random.normal("spread", 25_000)
    assert abs(float(drawn.mean())) < 0.013  # four times 1 / sqrt(100 000)
    assert abs(float(drawn.std()) - 1.0) < 0.009


def test_integers_reach_both_ends(random: WorldRandom) -> None:
    assert random.integers("lag", 2, 5, 200).unique().tolist() == [2, 3, 4]


def test_seeds_of_a_million_episodes_hardly_meet() -> None:
    """Of n draws from m values n^2 / 2 m meet: 233 of a million from 2^31."""
    worlds, episodes = np.divmod(np.arange(1_000_000), 1000)
    met = 1_000_000 - len(np.unique(episode_seeds(0, worlds, episodes)))
    assert 150 < met < 320
