# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Shows frames that are known beforehand: a recording, or a walk through a colon."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from arcgym.assets.force_tiers import tiers_of
from arcgym.managers import Episode
from arcgym.teleop.choices import Choice
from arcgym.teleop.frames import Frame
from arcgym.teleop.hand import Hand
from arcgym.teleop.session import Status
from arcgym.viewers.frame_info import FrameInfo
from arcgym.viewers.inside_views import camera_pose
from arcgym.viewers.palette import force_tier, shown_tiers

WALK_STEP = 0.005
"""Way between two frames of a walk [m]."""


class Player:
    """Plays frames like a film; a page shows it as it shows a session that nobody may steer."""

    needs_page = False
    generation = 1
    drivers: Mapping[str, Any] = {}

    def __init__(self, env: Any, make: Callable[[int], Frame], count: int, step_dt: float, title: str) -> None:
        """Prepare; :meth:`start` plays.

        Args:
            env: Environment with colon and robot, which is never stepped.
            make: Returns the frame of a number.
            count: Frames.
            step_dt: Time between two frames [s].
            title: What is shown, in a line.
        """
        self.env, self.count, self._make, self._step_dt = env, count, make, step_dt
        self.building = threading.Lock()
        self.hand = Hand(())
        self.speed = 1.0
        self.index = 0
        """Frame that is shown."""
        self.frame: Frame = make(0)
        self.status = Status(Choice(title), "paused", title, driver="the recording")
        self._playing = False
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="arcgym-player", daemon=True)

    def start(self) -> None:
        """Play in a thread of its own."""
        self.play(True)
        self._thread.start()

    def close(self) -> None:
        """End."""
        self._stop.set()
        self._thread.join()
        self.env.close()

    def play(self, playing: bool) -> None:
        """Go on, from the beginning if it has ended, or stop."""
        if playing and self.index == self.count - 1:
            self.seek(0)
        self._playing = playing
        self.status = replace(self.status, state="running" if playing else "paused")

    def seek(self, index: int) -> None:
        """Show a frame."""
        self.index = min(max(index, 0), self.count - 1)
        made = self._make(self.index)
        self.frame = replace(made, number=self.frame.number + 1)
        self.status = replace(self.status, steps=self.index)

    def _run(self) -> None:
        while not self._stop.is_set():
            time.sleep(self._step_dt / max(self.speed, 0.01))
            if self._playing:
                self.seek(self.index + 1)
            if self._playing and self.index == self.count - 1:
                self.play(False)


def recorded_frames(env: Any, episode: Episode) -> Callable[[int], Frame]:
    """Return the frames of an episode; without recorded wall positions the wall stays as it was at the start."""
    data, patient = episode.data, env.scene["colon"].patient_of(0)
    walls = data.get("wall/positions")
    start = data.get("initial_state/nodal_pos", np.asarray(patient.wall.points, np.float32))
    tiers, camera = shown_tiers(tiers_of(env.cfg)), env.scene["endoscope"].stage.camera

    def value(name: str, step: int, default: float = float("nan")) -> float:
        return float(data[name][step]) if name in data else default

    def largest(name: str, step: int) -> float:
        return float(data[name][step].max()) if name in data else float("nan")

    def make(step: int) -> Frame:
        link_pos, link_quat = data["poses/body_pos_w"][step], data["poses/body_quat_w"][step]
        window = np.linalg.norm(data["forces/window"][step], axis=-1)
        tip_force = float(np.linalg.norm(data["forces/tip"][step]))
        arc = value("poses/tip_arc_length", step)
        info = FrameInfo(
            time=(step + 1) * episode.info["step_dt"],
            segment=next((name for name, (low, high) in patient.bounds.items() if low <= arc < high), ""),
            tip_arc=arc,
            inserted=value("poses/inserted_length", step),
            tip_force=tip_force,
            max_force=float(window.max()),
            reward=value("rewards/total", step),
        )
        return Frame(
            step,
            walls[step] if walls is not None else start,
            link_pos,
            link_quat,
            window,
            _camera(link_pos[-1], link_quat[-1], camera),
            info,
            value("metrics/progress", step),
            value("metrics/looping_ratio", step),
            value("forces/base", step, 0.0),
            force_tier(tip_force, tiers).label,
            largest("wall/strain", step),
            largest("wall/anchor_tension", step),
            value("wall/lumen_pressure", step),
        )

    return make


def walk_frames(env: Any) -> tuple[Callable[[int], Frame], int]:
    """Return the frames of a walk along the centerline of a colon at rest, and their number; the robot goes along."""
    patient = env.scene["colon"].patient_of(0)
    stage = patient.stage
    tiers = shown_tiers(tiers_of(env.cfg))
    window = np.zeros(len(env.scene["endoscope"].data.window_arc))
    length = float(patient.centerline.arc[-1]) - 0.04
    ends = np.arange(0.02, length, WALK_STEP)

    def make(step: int) -> Frame:
        pose = camera_pose(stage, float(ends[step]))
        segment = next((name for name, (low, high) in patient.bounds.items() if low <= ends[step] < high), "")
        count = env.scene["endoscope"].num_bodies
        nothing = np.repeat(pose[None, :3], count, axis=0), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
        info = FrameInfo(segment=segment, tip_arc=float(ends[step]), inserted=float(ends[step]))
        nan = float("nan")
        points = np.asarray(patient.wall.points, np.float32)
        return Frame(step, points, *nothing, window, pose, info, nan, nan, 0.0, force_tier(0.0, tiers).label)

    return make, len(ends)


def _camera(position: np.ndarray, quaternion: np.ndarray, camera: Any) -> np.ndarray:
    """Return the pose of the camera of a tip link, shape (7,)."""
    turn = Rotation.from_quat(quaternion)
    place = position + turn.apply(np.asarray(camera.position, float))
    return np.r_[place, (turn * Rotation.from_quat(np.asarray(camera.quaternion, float))).as_quat()].astype(np.float32)
