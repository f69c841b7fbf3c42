# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Records a clip of the running environment every so many steps."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import gymnasium as gym
import numpy as np


class FrameSink(Protocol):
    """What a video file must offer."""

    def write(self, frame: np.ndarray) -> None:
        """Append a uint8 frame of shape (H, W, 3)."""

    def close(self) -> None:
        """Finish the file."""


class PeriodicVideo(gym.Wrapper):
    """Writes ``rl-video-step-<step>.mp4`` from ``env.render()``."""

    def __init__(
        self,
        env: gym.Env,
        folder: str | Path,
        open_video: Callable[[Path], FrameSink],
        *,
        length: int = 200,
        interval: int = 2000,
    ):
        """Wrap ``env``.

        Args:
            env: Environment whose ``render`` returns a uint8 frame of shape (H, W, 3).
            folder: Where the clips go.
            open_video: Opens a video file at a path.
            length: Control steps of a clip.
            interval: Control steps between the starts of two clips.
        """
        super().__init__(env)
        self.folder = Path(folder).resolve()
        self.folder.mkdir(parents=True, exist_ok=True)
        self.length = length
        self.interval = interval
        self.paths: list[Path] = []
        self._open_video = open_video
        self._video: FrameSink | None = None
        self._step = 0
        self._end = 0
        self._held: list[np.ndarray] = []

    def step(self, action: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Step the environment and record the frame after it.

        The first frame of a new episode is recorded with the next one: no clip ends with a jump back to the start.
        """
        result = self.env.step(action)
        if self._video is None and self._step % self.interval == 0:
            self._start()
        if self._video is not None:
            self._held.append(np.asarray(self.env.render()))
            if self._step == self._end - self.length or not self._begins_anew(result):
                self._record()
        self._step += 1
        if self._step >= self._end:
            self._finish()
        return result

    def close(self) -> None:
        """Finish the clip and close the environment."""
        self._finish()
        super().close()

    def _begins_anew(self, result: tuple[Any, ...]) -> bool:
        """Return whether the world that is filmed ended its episode in this step, and was reset."""
        cfg = self.env.unwrapped.cfg  # type: ignore[attr-defined]
        return bool(cfg.autoreset and (result[2][cfg.viewer.env_id] or result[3][cfg.viewer.env_id]))

    def _record(self) -> None:
        """Append the frames that wait; after an error of the disk the clip ends, and the run goes on."""
        try:
            while self._held:
                self._video.write(self._held.pop(0))  # type: ignore[union-attr]
        except OSError as error:
            print(f"video {self.paths[-1]} ends at step {self._step}: {error.strerror or error}", flush=True)
            with contextlib.suppress(OSError):
                self._finish()
            self._video = None

    def _start(self) -> None:
        path = self.folder / f"rl-video-step-{self._step}.mp4"
        self._video = self._open_video(path)
        self._end = self._step + self.length
        self.paths.append(path)

    def _finish(self) -> None:
        self._held.clear()
        if self._video is not None:
            self._video.close()
            self._video = None
