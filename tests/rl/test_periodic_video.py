# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import errno
import os

import numpy as np
import pytest
import torch

from arcgym.rl import PeriodicVideo


class FrameList:
    """Keeps the frames that a video file would hold."""

    def __init__(self):
        self.frames, self.closed = [], False

    def write(self, frame):
        self.frames.append(int(frame[0, 0, 0]))

    def close(self):
        self.closed = True


def test_full_disk_ends_the_clip_alone(counting_env, tmp_path, capsys):
    class FullDisk(FrameList):
        def write(self, frame):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    counting_env.render = lambda: np.zeros((2, 2, 3), dtype=np.uint8)
    env = PeriodicVideo(counting_env, tmp_path, lambda path: FullDisk(), length=2, interval=5)
    for _ in range(3):
        env.step(torch.zeros(2, 2))
    assert capsys.readouterr().out.count("No space left on device") == 1


def test_clips_start_at_the_interval(counting_env, tmp_path):
    videos = {}
    counting_env.render = lambda: np.full((2, 2, 3), counting_env.common_step_counter, dtype=np.uint8)
    env = PeriodicVideo(
        counting_env, tmp_path, lambda path: videos.setdefault(path.name, FrameList()), length=2, interval=5
    )
    for _ in range(8):
        env.step(torch.zeros(2, 2))
    assert {name: video.frames for name, video in videos.items()} == {
        "rl-video-step-0.mp4": [1, 2],
        "rl-video-step-5.mp4": [6, 7],
    }
    assert all(video.closed for video in videos.values())


@pytest.mark.parametrize(
    ("episode", "length", "frames"),
    [
        (3, 5, [1, 2, 3, 4, 5]),  # step 3 shows the next episode's start, and that episode goes on
        (3, 3, [1, 2]),  # here it would be the clip's last frame
        (1, 3, [1]),  # every frame is a start: the first stays
    ],
)
def test_no_clip_ends_with_the_start_of_the_next_episode(counting_env, tmp_path, episode, length, frames):
    video = FrameList()
    counting_env.max_episode_length = episode
    counting_env.render = lambda: np.full((2, 2, 3), counting_env.common_step_counter, dtype=np.uint8)
    env = PeriodicVideo(counting_env, tmp_path, lambda path: video, length=length, interval=10)
    for _ in range(length):
        env.step(torch.zeros(2, 2))
    assert video.frames == frames
    assert video.closed
