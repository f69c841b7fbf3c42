# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""MP4 files that play even when the program that wrote them was killed."""

from __future__ import annotations

from collections.abc import Generator
from pathlib import Path
from types import TracebackType

import imageio_ffmpeg
import numpy as np

_FRAGMENTED = ["-movflags", "+frag_keyframe+empty_moov+default_base_moof", "-flush_packets", "1"]
_LOW_DELAY = ["-tune", "zerolatency"]


class VideoRecorder:
    """Writes frames to an MP4 as they come, with the ffmpeg that imageio-ffmpeg brings along.

    The file is made of fragments of a second: after a kill, all but the last one play.

    Example:
        with VideoRecorder("episode.mp4", fps=10) as video:
            video.write(env.render())
    """

    def __init__(self, path: str | Path, fps: float = 10.0, quality: float = 7.0) -> None:
        """Prepare the file; it appears with the first frame.

        Args:
            path: Name of the file, ending in ``.mp4``; folders are made.
            fps: Frames per second of the playback; 1 / ``env.step_dt`` plays in real time.
            quality: 0 (small file) to 10 (best picture).

        Raises:
            ValueError: If the name does not end in ``.mp4`` or a number is out of range.
        """
        self.path = Path(path)
        if self.path.suffix != ".mp4":
            raise ValueError(f"video path '{self.path}' must end in .mp4")
        if fps <= 0.0 or not 0.0 <= quality <= 10.0:
            raise ValueError(f"video fps {fps} must be positive and quality {quality} within 0..10")
        self.fps = fps
        self.num_frames = 0
        self._quality = quality
        self._writer: Generator[None, bytes, None] | None = None
        self._shape: tuple[int, ...] | None = None
        self._is_closed = False

    def write(self, frame: np.ndarray) -> None:
        """Add a frame.

        Args:
            frame: uint8, shape (H, W, 3); H and W even and the same for all frames.

        Raises:
            ValueError: If the frame does not fit, or the recorder is closed.
        """
        if self._is_closed:
            raise ValueError(f"video {self.path} is closed; make a new VideoRecorder")
        self._check(frame)
        if self._writer is None:
            self._writer = self._open(frame.shape)
        self._writer.send(np.ascontiguousarray(frame).tobytes())
        self.num_frames += 1

    def close(self) -> None:
        """Finish the file; further calls do nothing."""
        self._is_closed = True
        if self._writer is not None:
            self._writer.close()
            self._writer = None

    def __enter__(self) -> VideoRecorder:
        """Return the recorder."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Finish the file, whether or not there was an error."""
        self.close()

    def _check(self, frame: np.ndarray) -> None:
        shape = frame.shape
        if frame.dtype != np.uint8 or len(shape) != 3 or shape[2] != 3 or shape[0] % 2 or shape[1] % 2:
            raise ValueError(f"video frame is {frame.dtype} {shape}; expected uint8 (H, W, 3) with even H and W")
        if self._shape is not None and shape != self._shape:
            raise ValueError(f"video frame is {shape}; the first frame of {self.path} was {self._shape}")
        self._shape = shape

    def _open(self, shape: tuple[int, ...]) -> Generator[None, bytes, None]:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        keyframes = ["-g", str(max(int(round(self.fps)), 1))]
        writer = imageio_ffmpeg.write_frames(
            str(self.path),
            (shape[1], shape[0]),
            fps=self.fps,
            codec="libx264",
            quality=self._quality,
            macro_block_size=2,
            ffmpeg_log_level="error",
            output_params=[*_LOW_DELAY, *keyframes, *_FRAGMENTED],
        )
        writer.send(None)
        return writer
