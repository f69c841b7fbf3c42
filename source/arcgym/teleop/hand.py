# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What people command by keys, buttons, sliders and gamepads, from any number of browser tabs."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence

import numpy as np

TIMEOUT = 1.0
"""Time without a sign of life from any page after which everything commanded is dropped [s]: the dead man's switch."""
HOLD = 0.3
"""Time that a held button's command lasts after its last repetition [s]."""

KEYS: dict[str, tuple[str, str]] = {
    "forward": ("KeyW", "KeyS"),
    "insertion": ("KeyW", "KeyS"),
    "right": ("KeyD", "KeyA"),
    "up": ("KeyR", "KeyF"),
    "pitch": ("KeyI", "KeyK"),
    "yaw": ("KeyJ", "KeyL"),
    "roll": ("KeyE", "KeyQ"),
    "insufflation": ("KeyG", "KeyB"),
}
"""Key that raises and key that lowers each axis, as browsers name them."""
PAD: dict[str, tuple[int, float]] = {
    "forward": (1, -1.0),
    "insertion": (1, -1.0),
    "right": (0, 1.0),
    "roll": (0, 1.0),
    "pitch": (3, -1.0),
    "yaw": (2, -1.0),
}
"""Axis of a gamepad of the standard layout and its sign; with ``right`` there, roll and up are on the triggers."""
DEAD_ZONE = 0.12
"""Deflection of a gamepad's stick below which it counts as centered."""


class Hand:
    """Commands of several sources, each an array of one entry an axis; the one that moved last leads.

    A source whose command is zero commands nothing. All methods may be called from any thread.
    """

    def __init__(self, axes: Sequence[str], clock: Callable[[], float] = time.monotonic) -> None:
        """Start with nothing commanded.

        Args:
            axes: Name of each action.
            clock: Time now [s].
        """
        self.axes, self._clock = tuple(axes), clock
        self.strength = 0.6
        """Command of a key or button, 0 to 1; with the shift key it is 1."""
        self._lock = threading.Lock()
        self._commands: dict[str, tuple[np.ndarray, float, float]] = {}
        self._alive = clock()

    def touch(self) -> None:
        """Note a sign of life from a page."""
        self._alive = self._clock()

    @property
    def is_alive(self) -> bool:
        """Whether there was a sign of life lately."""
        return self._clock() - self._alive <= TIMEOUT

    def command(self, source: str, values: np.ndarray, lasts: float = float("inf")) -> None:
        """Set what a source commands, shape (A,), for ``lasts`` seconds; what is no number counts as zero.

        Another number of values is of a robot that was here before and commands nothing.
        """
        if np.shape(values) != (len(self.axes),):
            return self.drop(source)
        now, values = self._clock(), np.clip(np.nan_to_num(values), -1.0, 1.0).astype(np.float32)
        with self._lock:
            moved = now
            if source in self._commands and np.array_equal(self._commands[source][0], values):
                moved = self._commands[source][1]
            self._commands[source] = (values, moved, now + lasts)

    def push(self, source: str, axis: str, sign: float) -> None:
        """Command one axis as a held button does."""
        values = np.zeros(len(self.axes), np.float32)
        values[self.axes.index(axis)] = sign * self.strength
        self.command(source, values, HOLD)

    def drop(self, source: str) -> None:
        """Forget a source, such as a tab that was closed."""
        with self._lock:
            self._commands.pop(source, None)

    def release(self) -> None:
        """Drop everything commanded."""
        with self._lock:
            self._commands.clear()

    def value(self) -> np.ndarray:
        """Return what is commanded now, shape (A,): that of the source that changed last and is not zero."""
        now = self._clock()
        if now - self._alive > TIMEOUT:
            self.release()
        with self._lock:
            self._commands = {name: one for name, one in self._commands.items() if one[2] > now}
            moving = [one for one in self._commands.values() if one[0].any()]
        return max(moving, key=lambda one: one[1])[0] if moving else np.zeros(len(self.axes), np.float32)

    def from_keys(self, keys: Sequence[str]) -> np.ndarray:
        """Return the command of pressed keys, shape (A,)."""
        strength = 1.0 if "ShiftLeft" in keys or "ShiftRight" in keys else self.strength
        return np.array([strength * _difference(KEYS.get(axis, ("", "")), keys) for axis in self.axes], np.float32)

    def from_pad(self, pad: Mapping[str, Sequence[float]]) -> np.ndarray:
        """Return the command of a gamepad's ``axes`` and ``buttons``, each -1 to 1, shape (A,)."""
        sticks, buttons = pad.get("axes", ()), pad.get("buttons", ())
        triggers = _at(buttons, 7) - _at(buttons, 6)
        bumpers = _at(buttons, 5) - _at(buttons, 4)
        values = []
        for axis in self.axes:
            if axis == "up":
                values.append(triggers)
            elif axis == "roll" and "right" in self.axes:
                values.append(bumpers)
            elif axis == "insufflation":
                values.append(_at(buttons, 0) - _at(buttons, 1))
            else:
                index, sign = PAD.get(axis, (99, 0.0))
                deflection = _at(sticks, index)
                values.append(sign * deflection if abs(deflection) > DEAD_ZONE else 0.0)
        return np.array(values, np.float32)


def _difference(pair: tuple[str, str], keys: Sequence[str]) -> float:
    return float(pair[0] in keys) - float(pair[1] in keys)


def _at(values: Sequence[float], index: int) -> float:
    return float(values[index]) if index < len(values) else 0.0
