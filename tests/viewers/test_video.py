# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Video files hold the frames that were written, also when the writer dies."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import imageio.v2 as imageio
import numpy as np
import pytest

from arcgym.viewers import VideoRecorder

WRITER = """
import sys, time
import numpy as np
from arcgym.viewers.video import VideoRecorder
video = VideoRecorder(sys.argv[1], fps=10)
for k in range(25):
    video.write(np.full((64, 96, 3), 10 * k, np.uint8))
time.sleep(1.0)
print("written", flush=True)
time.sleep(60)
"""


def frame(value: int) -> np.ndarray:
    return np.full((64, 96, 3), value, np.uint8)


def read(path: Path) -> list[np.ndarray]:
    return [np.asarray(picture) for picture in imageio.mimread(path, format="FFMPEG")]


def test_file_holds_every_frame(tmp_path):
    path = tmp_path / "deep" / "video.mp4"
    with VideoRecorder(path, fps=10) as video:
        for k in range(12):
            video.write(frame(20 * k))
    frames = read(path)
    assert len(frames) == video.num_frames == 12
    assert frames[0].shape == (64, 96, 3)
    np.testing.assert_allclose([f.mean() for f in frames], [20 * k for k in range(12)], atol=4)
    assert imageio.get_reader(path).get_meta_data()["fps"] == 10


def test_error_in_the_block_still_finishes_the_file(tmp_path):
    with pytest.raises(RuntimeError), VideoRecorder(tmp_path / "video.mp4") as video:
        video.write(frame(100))
        raise RuntimeError
    assert len(read(video.path)) == 1


@pytest.mark.parametrize("whole_group", [False, True], ids=["writer killed", "writer and encoder killed"])
def test_killed_writer_leaves_a_file_that_plays(tmp_path, whole_group):
    path = tmp_path / "video.mp4"
    process = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, start_new_session=True
    )
    assert process.stdout is not None and process.stdout.readline() == b"written\n"
    kill = os.killpg if whole_group else os.kill
    kill(process.pid, signal.SIGKILL)
    process.wait(timeout=10)
    process.stdout.close()
    wanted = 20 if whole_group else 25
    assert wait_for_frames(path, wanted) >= wanted


def wait_for_frames(path: Path, wanted: int) -> int:
    """Counts the frames again and again, for up to 5 s, until the encoder has finished."""
    for _ in range(10):
        if len(read(path)) >= wanted:
            break
        time.sleep(0.5)
    return len(read(path))


@pytest.mark.parametrize("bad", [np.zeros((64, 96, 3)), np.zeros((63, 96, 3), np.uint8), np.zeros((64, 96), np.uint8)])
def test_frames_that_do_not_fit_are_refused(tmp_path, bad):
    with VideoRecorder(tmp_path / "video.mp4") as video, pytest.raises(ValueError, match="expected uint8"):
        video.write(bad)


def test_size_must_not_change(tmp_path):
    with VideoRecorder(tmp_path / "video.mp4") as video:
        video.write(frame(0))
        with pytest.raises(ValueError, match="first frame"):
            video.write(np.zeros((32, 96, 3), np.uint8))


def test_closed_recorder_and_other_suffixes_are_refused(tmp_path):
    video = VideoRecorder(tmp_path / "video.mp4")
    video.close()
    with pytest.raises(ValueError, match="closed"):
        video.write(frame(0))
    with pytest.raises(ValueError, match=r"\.mp4"):
        VideoRecorder(tmp_path / "video.avi")


def test_nothing_written_leaves_no_file(tmp_path):
    with VideoRecorder(tmp_path / "video.mp4") as video:
        pass
    assert not video.path.exists()
