# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How often an image is copied on its way from the camera's memory into the rollout."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
import torch
from written_bytes import WrittenBytes

from arcgym.envs import mdp
from arcgym.managers import ObservationGroupCfg, ObservationManager, ObservationTermCfg

WORLDS, FRAMES, SIZE = 3, 5, 8
FRAME = 3 * SIZE * SIZE


@pytest.fixture
def camera() -> torch.Tensor:
    """Memory that the camera draws into, channels last."""
    return torch.zeros(WORLDS, SIZE, SIZE, 3, dtype=torch.uint8)


def manager_of(camera: torch.Tensor, history: int, **terms: ObservationTermCfg) -> ObservationManager:
    sensor = SimpleNamespace(data=SimpleNamespace(output={"rgb": camera}))
    env = SimpleNamespace(num_envs=WORLDS, device="cpu", scene={"camera": sensor})
    terms["rgb"] = ObservationTermCfg(func=mdp.rgb, history_length=history)
    group = ObservationGroupCfg(concatenate_dim=0, terms=terms)
    manager = ObservationManager({"policy": group}, env)  # type: ignore[arg-type]
    manager.compute()
    return manager


def test_one_copy_besides_the_frame_stack(camera) -> None:
    """The stack writes 5 frames a world, the rollout 5: nothing else between the camera and the learner's memory."""
    manager, rollout = manager_of(camera, FRAMES), torch.zeros(WORLDS, 3 * FRAMES, SIZE, SIZE, dtype=torch.uint8)
    with WrittenBytes() as stack:
        obs = manager.compute()["policy"]
    with WrittenBytes() as copy:
        rollout.copy_(obs)
    assert stack.total == WORLDS * FRAMES * FRAME
    assert copy.total == WORLDS * FRAMES * FRAME


def test_a_reset_adds_the_frames_of_its_world_alone(camera) -> None:
    """One of the worlds reads its new frame once more and fills 5 with it."""
    manager = manager_of(camera, FRAMES)
    manager.reset(torch.tensor([1]))
    with WrittenBytes() as written:
        manager.compute()
    assert written.total == WORLDS * FRAMES * FRAME + (1 + FRAMES) * FRAME


@pytest.mark.parametrize("others", [0, 1])
def test_without_history_an_image_is_copied_once(camera, others: int) -> None:
    terms = {"again": ObservationTermCfg(func=mdp.rgb)} if others else {}
    manager = manager_of(camera, 0, **terms)
    with WrittenBytes() as written:
        obs = manager.compute()["policy"]
    assert written.total == (1 + others) * WORLDS * FRAME
    assert obs.is_contiguous()


def test_observations_stay_when_the_camera_draws_again(camera) -> None:
    """Each step shifts the stack by one frame; what earlier steps returned is untouched."""
    manager, kept = manager_of(camera, 2), []
    for shade in (1, 2, 3):
        camera.fill_(shade)
        kept.append(manager.compute()["policy"])
    camera.fill_(9)
    assert [obs[0, ::3, 0, 0].tolist() for obs in kept] == [[0, 1], [1, 2], [2, 3]]
