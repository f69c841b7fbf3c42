# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch
from tensordict import TensorDict

from arcgym.managers.buffers import FrameBuffer
from arcgym.rl.replay import ReplayBatch, ReplayBuffer

NUM_ENVS, STACK = 3, 3


class Episodes:
    """Worlds whose every frame and reward is a number of its own, with random ends and the environment's history."""

    def __init__(self, seed: int = 0):
        self.random = torch.Generator().manual_seed(seed)
        self.history = FrameBuffer(STACK, NUM_ENVS, "cpu")
        self.number = 0
        self.truth: dict[float, tuple] = {}
        self.obs = self.observe()

    def observe(self, store: bool = True) -> TensorDict:
        self.number += 1
        frame = self.number * torch.ones(NUM_ENVS, 2, 2, 2) + 100 * torch.arange(NUM_ENVS)[:, None, None, None]
        stacked = self.history.append(frame.to(torch.int16), store).flatten(1, 2)
        return TensorDict({"policy": stacked, "critic": frame[:, 0, 0, :1]}, batch_size=[NUM_ENVS])

    def step_into(self, replay: ReplayBuffer, time_out_rate: float = 0.2) -> None:
        draw = torch.rand(NUM_ENVS, generator=self.random)
        time_outs, terminated = draw < time_out_rate, draw > 0.85
        before, final = self.obs, self.observe(store=False)
        actions = torch.rand(NUM_ENVS, 1, generator=self.random)
        rewards = self.number + 1000.0 * torch.arange(NUM_ENVS)
        done = time_outs | terminated
        self.history.reset(done.nonzero().flatten())
        self.obs = self.observe()
        replay.add(before, actions, rewards, done, time_outs, dict(final.items()))
        for world in range(NUM_ENVS):
            after = final if time_outs[world] else self.obs
            self.truth[float(rewards[world])] = (before[world], actions[world], after[world], float(terminated[world]))

    def check(self, batch) -> None:
        for k, reward in enumerate(batch.rewards.tolist()):
            before, action, after, terminated = self.truth[reward]
            assert torch.equal(batch.actions[k], action)
            assert batch.terminated[k] == terminated
            for name in ("policy", "critic"):
                assert torch.equal(batch.observations[name][k], before[name])
                if not terminated:
                    assert torch.equal(batch.next_observations[name][k], after[name])


def make_replay(episodes: Episodes, rows: int = 20) -> ReplayBuffer:
    return ReplayBuffer(episodes.obs, 1, rows * NUM_ENVS, "cpu", frame_stacks={"policy": STACK})


@pytest.mark.parametrize("time_out_rate", [0.0, 0.2, 0.6])
def test_samples_are_what_was_added_across_wraps_and_episode_ends(time_out_rate):
    torch.manual_seed(0)
    episodes = Episodes()
    replay = make_replay(episodes)
    for step in range(60):
        episodes.step_into(replay, time_out_rate)
        if step >= 1:
            episodes.check(replay.sample(64))
    assert replay.num_transitions == 60 * NUM_ENVS


def test_every_kept_transition_is_drawn_and_equally_often():
    """After 4 rows of 3 worlds without ends, the newest has no successor yet: 9 transitions, 1000 draws each."""
    torch.manual_seed(0)
    episodes = Episodes()
    replay = make_replay(episodes)
    for step in range(4):
        rewards = torch.arange(3.0) + 10 * step
        replay.add(episodes.obs, torch.zeros(3, 1), rewards, *[torch.zeros(3)] * 2, None)
    values, counts = replay.sample(9000).rewards.unique(return_counts=True)
    assert values.tolist() == [0, 1, 2, 10, 11, 12, 20, 21, 22]
    assert int(counts.min()) > 850
    assert int(counts.max()) < 1150


def test_each_frame_is_stored_once():
    """20 rows of 3 worlds: one frame of 2 x 2 x 2 int16 and one float32."""
    assert make_replay(Episodes()).num_bytes == 20 * 3 * (8 * 2 + 4)


def test_another_order_of_frames_is_noticed():
    """Newest first instead of oldest first shows once three frames of an episode are known."""
    episodes = Episodes()
    replay = make_replay(episodes)

    def add_reversed() -> None:
        obs = episodes.obs.clone()
        obs["policy"] = obs["policy"].unflatten(1, (STACK, 2)).flip(1).flatten(1, 2)
        replay.add(obs, torch.zeros(3, 1), torch.zeros(3), *[torch.zeros(3)] * 2, None)
        episodes.obs = episodes.observe()

    add_reversed()
    add_reversed()
    with pytest.raises(ValueError, match="'policy' is not its last 3 frames, oldest first"):
        add_reversed()


def test_memory_is_taken_with_the_first_transition():
    episodes = Episodes()
    replay = make_replay(episodes)
    assert replay._obs == {}
    episodes.step_into(replay)
    assert sum(value.numel() * value.element_size() for value in replay._obs.values()) == replay.num_bytes


def test_saved_replay_goes_on_with_a_fresh_start():
    torch.manual_seed(0)
    episodes = Episodes()
    replay, resumed = make_replay(episodes), make_replay(episodes)
    for _ in range(30):
        episodes.step_into(replay)
    resumed.load_state_dict(replay.state_dict())
    restarted = Episodes(seed=1)
    restarted.number = episodes.number
    restarted.truth = episodes.truth
    restarted.history.reset(slice(None))
    restarted.obs = restarted.observe()
    for _ in range(8):
        restarted.check(resumed.sample(64))
        restarted.step_into(resumed)


def test_time_out_without_final_observations_is_refused():
    episodes = Episodes()
    with pytest.raises(ValueError, match="env.compute_final_obs=True"):
        make_replay(episodes).add(episodes.obs, torch.zeros(3, 1), torch.zeros(3), *[torch.ones(3)] * 2, None)


def test_small_memory_is_refused():
    with pytest.raises(ValueError, match="has 4 for each of 3 worlds, expected at least 5"):
        make_replay(Episodes(), rows=4)


def test_stack_must_divide_the_channels():
    with pytest.raises(ValueError, match="'policy'.* is 4, which does not divide the 6 channels"):
        ReplayBuffer(Episodes().obs, 1, 60, "cpu", frame_stacks={"policy": 4})


def test_empty_memory_says_so():
    with pytest.raises(ValueError, match="no complete transition"):
        make_replay(Episodes()).sample(1)


def numbered(number: float) -> TensorDict:
    return TensorDict({"policy": torch.full((1, 1), float(number))}, batch_size=[1])


def n_step_by_number(ends: dict[int, str], num_steps: int = 3) -> dict[float, tuple]:
    """What transitions over several steps are like that start at observation 0, 1, ... of six steps of reward 1."""
    torch.manual_seed(0)
    replay = ReplayBuffer(numbered(0), 1, 20, "cpu")
    for step in range(6):
        end = torch.tensor([step in ends])
        time_out = torch.tensor([ends.get(step) == "time-out"])
        replay.add(
            numbered(step), torch.zeros(1, 1), torch.ones(1), end, time_out, {"policy": torch.full((1, 1), 99.0)}
        )
    batch = replay.sample(200, num_steps, gamma=0.5)
    following = torch.where(batch.terminated > 0, -1.0, batch.next_observations["policy"][:, 0])
    columns = (batch.observations["policy"][:, 0], batch.rewards, batch.discounts, following)
    return {row[0]: row[1:] for row in zip(*(column.tolist() for column in columns), strict=True)}


def test_several_steps_add_up_and_end_at_the_newest_observation():
    """1 + 0.5 + 0.25 over three steps; fewer where nothing newer is stored."""
    assert n_step_by_number({}) == {
        0.0: (1.75, 0.125, 3.0),
        1.0: (1.75, 0.125, 4.0),
        2.0: (1.75, 0.125, 5.0),
        3.0: (1.5, 0.25, 5.0),
        4.0: (1.0, 0.5, 5.0),
    }


def test_several_steps_end_with_the_episode():
    """Step 1 ends the task; step 3 is cut short, so that its final observation, 99, follows."""
    found = n_step_by_number({1: "end", 3: "time-out"})
    assert found == {
        0.0: (1.5, 0.25, -1.0),
        1.0: (1.0, 0.5, -1.0),
        2.0: (1.5, 0.25, 99.0),
        3.0: (1.0, 0.5, 99.0),
        4.0: (1.0, 0.5, 5.0),
    }


def test_images_are_stored_small():
    """A block of 4x4 pixels with values 0 to 15 becomes one of 7.5, rounded to 8."""
    image = torch.arange(16, dtype=torch.uint8).view(1, 1, 4, 4)
    obs = TensorDict({"policy": image}, batch_size=[1])
    replay = ReplayBuffer(obs, 1, 10, "cpu", shrink={"policy": 4})
    for _ in range(3):
        replay.add(obs, torch.zeros(1, 1), torch.zeros(1), torch.zeros(1), torch.zeros(1), None)
    assert replay.num_bytes == 10
    assert replay.sample(1).observations["policy"].tolist() == [[[[8]]]]


def test_a_batch_splits_into_batches() -> None:
    numbers = torch.arange(6.0)
    whole = TensorDict({"policy": numbers[:, None]}, batch_size=[6])
    batch = ReplayBatch(whole, numbers[:, None], numbers, whole, numbers, numbers)
    parts = batch.split(3)
    assert [part.rewards.tolist() for part in parts] == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]
    assert parts[1].next_observations["policy"].flatten().tolist() == [3.0, 4.0, 5.0]
