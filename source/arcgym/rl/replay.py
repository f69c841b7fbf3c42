# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Replay memory on the training device that stores every image once."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, cast

import torch
from tensordict import TensorDict

from arcgym.rl.augmentation import shrink_images
from arcgym.utils.errors import UsageError


@dataclass(frozen=True)
class ReplayBatch:
    """B transitions."""

    observations: TensorDict
    """What the action was chosen from."""

    actions: torch.Tensor
    """Actions, shape (B, A)."""

    rewards: torch.Tensor
    """Rewards, shape (B,); of several steps their discounted sum."""

    next_observations: TensorDict
    """What came after; after a time-out the episode's final observation. Meaningless where ``terminated``."""

    terminated: torch.Tensor
    """1 where nothing follows, 0 elsewhere, also after a time-out, float32, shape (B,)."""

    discounts: torch.Tensor
    """What the value of ``next_observations`` is multiplied by, shape (B,): the discount of a step to the power of the
    steps in between."""

    def split(self, size: int) -> list[ReplayBatch]:
        """Return batches of ``size`` transitions, without copies."""
        values = {field.name: getattr(self, field.name).split(size) for field in fields(self)}
        return [ReplayBatch(**dict(zip(values, parts, strict=True))) for parts in zip(*values.values(), strict=True)]


class ReplayBuffer:
    """A ring of observations for each of N worlds; a transition is a row and the one after it.

    Image groups that stack the last K frames are stored as single frames and stacked again when they are sampled:
    before the start of an episode its first frame is repeated, as the environment's history does. The final observation
    of an episode that ended by time-out takes a row of its own, which no transition starts from.
    """

    def __init__(
        self,
        obs: TensorDict,
        num_actions: int,
        capacity: int,
        device: str,
        frame_stacks: dict[str, int] | None = None,
        shrink: dict[str, int] | None = None,
    ):
        """Plan the memory; images and vectors take theirs with the first transition, so that playing needs none.

        Args:
            obs: Observations of one step of all worlds; dtypes are kept.
            num_actions: Size of the action.
            capacity: Observations to keep, of all worlds together.
            device: Where they are kept and sampled.
            frame_stacks: Frames in the channels of each stacked image group, oldest first; others count one.
            shrink: Edge of the blocks of pixels that become one in each image group, see
                :func:`arcgym.rl.augmentation.shrink_images`; others are stored as they are.

        Raises:
            UsageError: If a stack does not divide the channels of its group, or the memory is too small for one.
        """
        self.device, self.num_envs = device, int(obs.batch_size[0])
        self.frame_stacks = _check_stacks(obs, frame_stacks or {})
        self.shrink = shrink or {}
        self.num_rows = capacity // self.num_envs
        self._history = max([1, *self.frame_stacks.values()]) - 1
        if self.num_rows < self._history + 3:
            raise UsageError(
                f"A replay of {capacity} observations has {self.num_rows} for each of {self.num_envs} worlds, expected "
                f"at least {self._history + 3}: raise agent.algorithm.replay_size or lower the number of worlds."
            )
        shape = (self.num_rows, self.num_envs)
        self._layout = {
            name: (torch.Size((*shape, *self._newest(name, value).shape[1:])), value.dtype)
            for name, value in cast(dict[str, torch.Tensor], obs).items()
        }
        self._obs: dict[str, torch.Tensor] = {}
        self._actions = torch.zeros(*shape, num_actions, device=device)
        self._rewards = torch.zeros(shape, device=device)
        self._terminated = torch.zeros(shape, dtype=torch.bool, device=device)
        self._is_start = torch.zeros(shape, dtype=torch.bool, device=device)
        self._age = torch.zeros(shape, dtype=torch.long, device=device)
        self._count = torch.zeros(self.num_envs, dtype=torch.long, device=device)
        self._steps = torch.zeros(self.num_envs, dtype=torch.long, device=device)
        self._worlds = torch.arange(self.num_envs, device=device)
        self.num_transitions = 0
        """Transitions ever added."""

    @property
    def num_bytes(self) -> int:
        """Memory taken by observations [bytes]."""
        return sum(shape.numel() * torch.empty(0, dtype=dtype).element_size() for shape, dtype in self._layout.values())

    def add(
        self,
        obs: TensorDict,
        actions: torch.Tensor,
        rewards: torch.Tensor,
        dones: torch.Tensor,
        time_outs: torch.Tensor,
        final_obs: dict[str, torch.Tensor] | None,
    ) -> None:
        """Add one transition of every world.

        Args:
            obs: What the actions were chosen from.
            actions: Actions, shape (N, A).
            rewards: Rewards, shape (N,).
            dones: Whether the episode ended, shape (N,).
            time_outs: Whether it ended by time-out, shape (N,).
            final_obs: Observations after the step and before the reset; needed where ``time_outs``.

        Raises:
            UsageError: If a time-out comes without final observations, or, looked at in the first steps, an image group
                is not the stack that was configured.
        """
        self._allocate()
        done, time_outs = dones.to(self.device) > 0, time_outs.to(self.device) > 0
        row = self._count % self.num_rows
        self._write(row, self._worlds, obs)
        if self.num_transitions < _CHECKED_STEPS * self.num_envs:
            self._check_rebuilt(obs)
        self._actions[row, self._worlds] = actions.to(self.device)
        self._rewards[row, self._worlds] = rewards.to(self.device)
        self._terminated[row, self._worlds] = done & ~time_outs
        self._is_start[row, self._worlds] = True
        self._count += 1
        self._steps += 1
        self._add_final(time_outs.nonzero().flatten(), final_obs)
        self._steps.masked_fill_(done, 0)
        self.num_transitions += self.num_envs

    def cut(self) -> None:
        """End every episode here without a final observation, because the environment starts anew."""
        newest = (self._count - 1) % self.num_rows
        self._is_start[newest, self._worlds] = False
        self._steps.zero_()

    def sample(self, batch_size: int, num_steps: int = 1, gamma: float = 1.0) -> ReplayBatch:
        """Return transitions drawn uniformly, with replacement, from all whose observations are complete.

        Args:
            batch_size: Number of transitions B.
            num_steps: Steps that a transition leads over; fewer where the episode ends or nothing newer is stored.
            gamma: Discount of a step.

        Raises:
            ValueError: If there is none yet.
        """
        world, index = self._draw(batch_size)
        row = index % self.num_rows
        rewards, last = self._rewards[row, world].clone(), index.clone()
        discounts = torch.full_like(rewards, gamma)
        for _ in range(num_steps - 1):
            following = (last + 1) % self.num_rows
            goes_on = ~self._terminated[last % self.num_rows, world] & self._is_start[following, world]
            goes_on &= last + 2 < self._count[world]
            rewards += torch.where(goes_on, discounts * self._rewards[following, world], 0.0)
            discounts = torch.where(goes_on, gamma * discounts, discounts)
            last += goes_on
        return ReplayBatch(
            observations=self._observations(index, world),
            actions=self._actions[row, world],
            rewards=rewards,
            next_observations=self._observations(last + 1, world),
            terminated=self._terminated[last % self.num_rows, world].float(),
            discounts=discounts,
        )

    def state_dict(self) -> dict[str, Any]:
        """Return everything stored, without copies."""
        return {name: value for name, value in vars(self).items() if name in _STATE}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        """Restore what was stored by a memory of the same shapes, and cut the episodes that were under way.

        Raises:
            UsageError: If the shapes differ.
        """
        if state["_actions"].shape != self._actions.shape:
            have, want = tuple(state["_actions"].shape), tuple(self._actions.shape)
            raise UsageError(f"The saved replay has rows, worlds, actions {have}, expected {want}.")
        self._allocate()
        for name, value in self._obs.items():
            value.copy_(state["_obs"][name])
        for name in _STATE - {"_obs", "num_transitions"}:
            getattr(self, name).copy_(state[name])
        self.num_transitions = state["num_transitions"]
        self.cut()

    def _allocate(self) -> None:
        if not self._obs:
            layout = self._layout.items()
            with torch.inference_mode(False):  # written in the rollout, read by the update
                self._obs = {name: torch.zeros(s, dtype=dtype, device=self.device) for name, (s, dtype) in layout}

    def _write(self, row: torch.Tensor, world: torch.Tensor, obs: Any) -> None:
        for name, store in self._obs.items():
            store[row, world] = self._newest(name, obs[name]).to(self.device)
        self._age[row, world] = self._steps[world]

    def _check_rebuilt(self, obs: TensorDict) -> None:
        """Compare the observations with what :meth:`sample` would make of the frames stored so far."""
        is_known = self._steps >= self._history
        rebuilt = self._observations(self._count, self._worlds)
        for name, stack in self.frame_stacks.items():
            if not torch.equal(rebuilt[name][is_known], self._stored(name, obs[name]).to(self.device)[is_known]):
                raise UsageError(
                    f"Group '{name}' is not its last {stack} frames, oldest first: set agent.algorithm.frame_stacks as "
                    "the task's history_length, or leave the group out to store it whole."
                )

    def _add_final(self, world: torch.Tensor, final_obs: dict[str, torch.Tensor] | None) -> None:
        if len(world) == 0:
            return
        if final_obs is None:
            raise UsageError(
                "A world timed out and extras hold no final_obs, which off-policy learning bootstraps from. "
                "Set env.compute_final_obs=True."
            )
        row = self._count[world] % self.num_rows
        self._write(row, world, {name: final_obs[name][world.to(final_obs[name].device)] for name in self._obs})
        self._is_start[row, world] = False
        self._count[world] += 1

    def _newest(self, name: str, value: torch.Tensor) -> torch.Tensor:
        """Return the newest frame of a stacked group, the whole of another, in the size that is stored."""
        stack = self.frame_stacks.get(name, 1)
        return self._stored(name, value if stack == 1 else value[:, -(value.shape[1] // stack) :])

    def _stored(self, name: str, value: torch.Tensor) -> torch.Tensor:
        """Return observations of a group in the size that is stored."""
        return shrink_images(value, self.shrink[name]) if self.shrink.get(name, 1) > 1 else value

    def _draw(self, batch_size: int) -> tuple[torch.Tensor, torch.Tensor]:
        """Worlds and indices (rows counted from the first ever written) of transitions, each of shape (B,)."""
        oldest = torch.where(self._count > self.num_rows, self._count - self.num_rows + self._history, 0)
        number = (self._count - 1 - oldest).clamp(min=0)
        if self.num_transitions < 2 * self.num_envs:
            raise ValueError("The replay holds no complete transition yet, expected at least two steps of each world.")
        world, index = self._candidates(batch_size, oldest, number)
        for _ in range(_MAX_REDRAWS):
            wrong = ~self._is_start[index % self.num_rows, world]
            if not bool(wrong.any()):
                return world, index
            again_world, again_index = self._candidates(batch_size, oldest, number)
            world, index = torch.where(wrong, again_world, world), torch.where(wrong, again_index, index)
        raise ValueError(
            "The replay holds hardly anything but the ends of episodes: raise agent.algorithm.replay_size."
        )

    def _candidates(
        self, batch_size: int, oldest: torch.Tensor, number: torch.Tensor
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """Rows drawn uniformly over all worlds; worlds differ in how many they hold."""
        ends = number.cumsum(0)
        draw = (torch.rand(batch_size, device=self.device, dtype=torch.float64) * ends[-1]).long()
        draw = torch.minimum(draw, ends[-1] - 1)
        world = torch.searchsorted(ends, draw, right=True)
        return world, oldest[world] + draw - (ends - number)[world]

    def _observations(self, index: torch.Tensor, world: torch.Tensor) -> TensorDict:
        age = self._age[index % self.num_rows, world]
        values = {}
        for name, store in self._obs.items():
            stack = self.frame_stacks.get(name, 1)
            back = torch.arange(stack - 1, -1, -1, device=self.device)
            rows = (index.unsqueeze(1) - torch.minimum(age.unsqueeze(1), back)) % self.num_rows
            frames = store[rows, world.unsqueeze(1)]
            values[name] = frames.squeeze(1) if stack == 1 else frames.flatten(1, 2)
        return TensorDict(values, batch_size=[len(index)], device=self.device)


_CHECKED_STEPS = 100
_MAX_REDRAWS = 10_000
_STATE = {"_obs", "_actions", "_rewards", "_terminated", "_is_start", "_age", "_count", "num_transitions"}


def _check_stacks(obs: TensorDict, stacks: dict[str, int]) -> dict[str, int]:
    for name, stack in stacks.items():
        if name not in obs.keys():  # noqa: SIM118 - a TensorDict iterates over its batch
            raise UsageError(f"frame_stacks names the group '{name}'; observed are: {', '.join(map(str, obs.keys()))}.")
        if stack < 1 or obs[name].shape[1] % stack:
            raise UsageError(
                f"frame_stacks['{name}'] is {stack}, which does not divide the {obs[name].shape[1]} channels."
            )
    return dict(stacks)
