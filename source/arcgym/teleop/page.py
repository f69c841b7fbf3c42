# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The page in the browser: two views, numbers, and controls, made with viser."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import viser

from arcgym.assets.force_tiers import tiers_of
from arcgym.assets.materials import TISSUE_PRESETS
from arcgym.teleop import choices
from arcgym.teleop.gate import Gate
from arcgym.teleop.hand import KEYS, Hand
from arcgym.teleop.hand_server import HandServer
from arcgym.teleop.looker import Looker, link_mesh
from arcgym.teleop.player import Player
from arcgym.teleop.readouts import readouts
from arcgym.teleop.session import HAND, Session
from arcgym.viewers.palette import FORCE_TIERS, shown_tiers

SURFACE_PERIOD = 0.25
"""Least time between two shapes of the colon's surface [s]: each takes 160 kB."""
REDUCED_SURFACE_PERIOD = 1.0
"""The same in a reduced session [s]."""
TEXT_PERIOD = 0.2
"""Least time between two sets of numbers [s]."""
LONGEST_START = 300.0
"""Time after which speed is measured though nothing was drawn yet [s]."""
BACKGROUND = (222, 228, 238)
"""Color behind the colon."""
TASKS_OWN = "the task's"
"""Choice of what the task has."""
COLON_COLOR = (228, 132, 116)
"""Color of the colon from outside."""


class Page:
    """Shows a session and lets people steer it."""

    def __init__(
        self, session: Session | Player, host: str, port: int, token: str | None, size: int = 320, steers: bool = True
    ) -> None:
        """Start the servers; the page fills itself once the session has a world.

        Args:
            session: A session or player, started or not.
            host: Address to listen at.
            port: Port; 0 takes a free one.
            token: What a browser must know; None for loopback.
            size: Width and height of the endoscope's view [px].
            steers: Whether people may steer, or just look.
        """
        self._session: Any = session
        self._size, self._steers = size, steers
        self._viser = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
        self.hand_server = HandServer(session, steers)
        script = files("arcgym.teleop").joinpath("page.js").read_bytes()
        index = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_bytes()
        index = index.replace(b"<head>", b'<head><script src="/arcgym.js"></script>', 1)
        index = index.replace(b"<title>Viser</title>", b"<title>ARCGym</title>", 1)
        html = ("text/html; charset=utf-8", index)
        pages = {"/": html, "/index.html": html, "/arcgym.js": ("application/javascript", script)}
        ports = {"*": self._viser.get_port(), "/hand": self.hand_server.port}
        self.gate = Gate(host, port, token, pages, ports)
        self.gate.start()
        self._generation, self._tiers = -1, FORCE_TIERS
        self._looker: Looker | None = None
        self._colon: Any = None
        self._middle: Any = np.zeros(3)
        self._drawn, self._surface_at, self._text_at = -1, 0.0, 0.0
        self._times: deque[float] = deque(maxlen=11)
        self.pictures = 0
        """Pictures drawn so far."""
        self._axis_controls: list[Any] = []
        self._sliders: list[Any] = []
        self._build()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="arcgym-page", daemon=True)
        self._thread.start()

    def measure(self, seconds: float) -> str:
        """Let a session run for a while and return its control steps and pictures a second, in a line."""
        session = self._session
        begun = time.monotonic()
        while self.pictures < 3 and session.status.state != "failed" and time.monotonic() - begun < LONGEST_START:
            time.sleep(0.1)  # building takes a while, and first pictures compile kernels
        before, start = self._counts(), time.perf_counter()
        time.sleep(seconds)
        spent = time.perf_counter() - start
        steps, pictures, stepping, drawing = (now - then for now, then in zip(self._counts(), before, strict=True))
        return (
            f"measured over {spent:.1f} s: {steps / spent:.1f} control steps/s, {pictures / spent:.1f} pictures/s of "
            f"{self._size} px; processor time: {1000.0 * stepping / max(steps, 1):.0f} ms a step in one thread, "
            f"{1000.0 * drawing / max(pictures, 1):.0f} ms a picture in another"
        )

    def _counts(self) -> tuple[float, float, float, float]:
        """Return control steps and pictures so far, and the processor times of the threads that make them [s]."""
        clocks = [time.pthread_getcpuclockid(thread.ident or 0) for thread in (self._session.thread, self._thread)]
        stepping, drawing = (time.clock_gettime(clock) for clock in clocks)
        return self._session.frames, self.pictures, stepping, drawing

    def close(self) -> None:
        """Stop showing."""
        self._stop.set()
        self._thread.join(timeout=5.0)
        self.gate.close()
        self.hand_server.close()
        self._viser.stop()

    def _build(self) -> None:
        server, gui = self._viser, self._viser.gui
        gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False, control_width="large")
        server.scene.set_up_direction("+z")
        server.scene.set_background_image(np.full((8, 8, 3), BACKGROUND, np.uint8))
        server.scene.add_light_ambient("/light", intensity=0.25)
        panel = gui.add_panel()
        with panel.add_tab("Endoscope"):
            self._image = gui.add_image(np.zeros((self._size, self._size, 3), np.uint8), jpeg_quality=85)
            if self._steers:
                self._hand_folder = gui.add_folder("Hand")
        panel.dock_left()
        panel.set_width(560)
        gui.main_panel.dock_right()
        self._text = gui.add_html("")
        if isinstance(self._session, Player):
            self._build_player(gui, self._session)
        elif self._steers:
            self._build_run(gui)
            self._build_recording(gui)
        self._build_choice(gui)

    def _build_player(self, gui: Any, player: Player) -> None:
        with gui.add_folder("Play"):
            buttons = gui.add_button_group("", ("Play", "Stop"))
            self._place = gui.add_slider("frame", min=0, max=max(player.count - 1, 1), step=1, initial_value=0)
            pace = gui.add_slider("pace", min=0.1, max=5.0, step=0.1, initial_value=1.0)
        buttons.on_click(lambda event: player.play(event.target.value == "Play"))
        self._place.on_update(lambda event: player.seek(self._place.value) if event.client is not None else None)
        pace.on_update(lambda _: setattr(player, "speed", pace.value))

    def _build_run(self, gui: Any) -> None:
        session = self._session
        with gui.add_folder("Run"):
            buttons = gui.add_button_group("", ("Go", "Pause", "Step"))
            pace = gui.add_slider("pace", min=0.05, max=2.0, step=0.05, initial_value=session.speed)
            self._driver = gui.add_dropdown(
                "driver", (HAND, *session.drivers), initial_value=session.status.choice.driver
            )
        acts = {"Go": lambda: session.pause(False), "Pause": lambda: session.pause(True), "Step": session.single_step}
        buttons.on_click(lambda event: acts[event.target.value]())
        pace.on_update(lambda _: setattr(session, "speed", pace.value))
        self._driver.on_update(lambda event: session.give(self._driver.value) if event.client is not None else None)

    def _build_recording(self, gui: Any) -> None:
        session = self._session
        with gui.add_folder("Recording"):
            name = gui.add_text("mark as", "")
            first = gui.add_button_group("", ("Mark", "Undo", "Save"))
            self._marks = gui.add_dropdown("go back to", ("start",))
            back = gui.add_button("Undo to this mark")
            last = gui.add_button_group("", ("Start anew", "Discard"))
        acts = {"Mark": lambda: session.mark(name.value), "Undo": session.undo, "Save": session.save}
        first.on_click(lambda event: acts[event.target.value]())
        back.on_click(lambda _: session.undo(_index(session.status.marks, self._marks.value)))
        last.on_click(lambda event: session.start_anew(keep=event.target.value == "Start anew"))

    def _build_choice(self, gui: Any) -> None:
        now = self._session.status.choice
        with gui.add_folder("World", expand_by_default=self._steers):
            self._opacity = gui.add_slider("colon opacity", min=0.05, max=1.0, step=0.05, initial_value=0.4)
            views = gui.add_button_group("view from", ("front", "left", "above"))
            if self._steers:
                task = gui.add_dropdown("task and robot", choices.tasks(), initial_value=now.task)
                given = {"patient": choices.patients(), "tissue": TISSUE_PRESETS, "start": ("segment", "rest")}
                fields = {name: self._option(gui, name, options) for name, options in given.items()}
                gui.add_button("Load").on_click(lambda _: self._load(task.value, fields))
        self._opacity.on_update(lambda _: self._fade())
        views.on_click(lambda event: self._turn(event.client, event.target.value))

    def _load(self, task: str, fields: Mapping[str, Any]) -> None:
        chosen = {name: None if one.value == TASKS_OWN else one.value for name, one in fields.items()}
        now = self._session.status.choice
        settings = now.settings if task == now.task else None
        self._session.load(replace(now, task=task, driver=HAND, settings=settings, **chosen))

    def _option(self, gui: Any, name: str, options: Iterable[str]) -> Any:
        """Make a choice of something that a task has a value of its own for."""
        now = getattr(self._session.status.choice, name)
        known = dict.fromkeys([TASKS_OWN, *options, *([now] if now else [])])
        return gui.add_dropdown(name, tuple(known), initial_value=now or TASKS_OWN)

    def _fade(self) -> None:
        if self._colon is not None:
            self._colon.opacity = self._opacity.value

    def _turn(self, client: Any, name: str) -> None:
        """Look at the colon from another side: +Y is anterior, +X the patient's right."""
        directions = {"front": (0.0, 0.62, 0.08), "left": (-0.62, 0.05, 0.08), "above": (0.0, 0.05, 0.7)}
        client.camera.position = tuple(self._middle + np.array(directions[name]))
        client.camera.look_at = tuple(self._middle)

    def _run(self) -> None:
        while not self._stop.is_set():
            if not self._show():
                time.sleep(0.01)

    def _show(self) -> bool:
        """Bring the page up to date; whether there was something to do."""
        session = self._session
        with session.building:
            frame = session.frame
            if session.env is not None and session.generation != self._generation and frame is not None:
                self._world()
            busy = frame is not None and frame.number != self._drawn and self._looker is not None
            if busy:
                self._draw(frame)
        if time.monotonic() - self._text_at > TEXT_PERIOD:
            self._text_at = time.monotonic()
            self._tell()
        return busy

    def _world(self) -> None:
        """Show another world."""
        session = self._session
        self._tiers = shown_tiers(tiers_of(session.env.cfg))
        self._looker = Looker(session.env, self._tiers, self._size)
        points, scene = self._looker.surface(session.frame), self._viser.scene
        self._middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        self._viser.initial_camera.position = tuple(self._middle + np.array([0.0, 0.62, 0.08]))
        self._viser.initial_camera.look_at = tuple(self._middle)
        self._colon = scene.add_mesh_simple(
            "/colon", points, self._looker.faces, color=COLON_COLOR, opacity=self._opacity.value, side="double",
            cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        vertices, faces = link_mesh()
        frame = session.frame
        self._scope = scene.add_batched_meshes_simple(
            "/scope", vertices, faces, frame.link_quat[:, [3, 0, 1, 2]], frame.link_pos, lod="off",
            batched_scales=self._looker.link_scale, batched_colors=self._looker.link_colors(frame), cast_shadow=False,
            receive_shadow=False,
        )  # fmt: skip
        self._drawn, self._generation = -1, session.generation
        if self._steers:
            self._axes()

    def _axes(self) -> None:
        """Make a pair of held buttons and a slider for each action."""
        for control in self._axis_controls:
            control.remove()
        hand, gui = self._session.hand, self._viser.gui
        names, units = choices.axes_of(self._session.env)
        self._sliders = []
        with self._hand_folder:
            self._axis_controls = [gui.add_markdown(_key_help(hand.axes))]
            for axis, unit in zip(names, units, strict=True):
                slider = gui.add_slider(f"{axis} [{unit}]", min=-1.0, max=1.0, step=0.05, initial_value=0.0)
                slider.on_update(lambda _: self._slide())
                self._sliders.append(slider)
            stop = gui.add_button("Stop", color="red")
            strength = gui.add_slider("keys and buttons", min=0.1, max=1.0, step=0.05, initial_value=hand.strength)
            buttons = gui.add_folder("Buttons to hold", expand_by_default=False)
        stop.on_click(lambda _: self._release())
        strength.on_update(lambda _: setattr(hand, "strength", strength.value))
        self._axis_controls += [*self._sliders, stop, strength, buttons]
        with buttons:
            for axis in names:
                for sign, mark in ((-1.0, "−"), (1.0, "+")):
                    button = gui.add_button(f"{mark} {axis}")
                    button.on_hold(_pusher(hand, axis, sign), callback_hz=10.0)

    def _slide(self) -> None:
        self._session.hand.command("sliders", np.array([slider.value for slider in self._sliders]))

    def _release(self) -> None:
        for slider in self._sliders:
            slider.value = 0.0
        self._session.hand.release()

    def _draw(self, frame: Any) -> None:
        assert self._looker is not None
        self._drawn = frame.number
        self._image.image = self._looker.picture(frame)
        with self._viser.atomic():
            self._scope.batched_positions = frame.link_pos
            self._scope.batched_wxyzs = frame.link_quat[:, [3, 0, 1, 2]]
            self._scope.batched_colors = self._looker.link_colors(frame)
        reduced = self._session.status.choice.reduced
        if time.monotonic() - self._surface_at > (REDUCED_SURFACE_PERIOD if reduced else SURFACE_PERIOD):
            self._surface_at = time.monotonic()
            self._colon.vertices = self._looker.surface(frame)
        self._times.append(time.monotonic())
        self.pictures += 1

    def _tell(self) -> None:
        """Bring numbers, marks and driver up to date, and sliders back where nobody holds them."""
        session, status = self._session, self._session.status
        spent = self._times[-1] - self._times[0] if len(self._times) > 1 else 0.0
        rate = (len(self._times) - 1) / spent if spent > 0.0 else 0.0
        latency = self.hand_server.latency if self.hand_server.tabs else math.nan
        self._text.content = readouts(session.frame, status, self._tiers, latency, rate)
        if isinstance(session, Player):
            self._place.value = session.index
        if not self._steers:
            return
        if status.marks and tuple(self._marks.options) != status.marks:
            self._marks.options = status.marks
            self._marks.value = status.marks[-1]
        if self._driver.value != status.driver:
            self._driver.value = status.driver
        if session.needs_page and not session.hand.is_alive and any(slider.value for slider in self._sliders):
            self._release()


def _pusher(hand: Hand, axis: str, sign: float) -> Callable[[Any], None]:
    """Return what a held button calls."""
    return lambda _: hand.push(f"button {axis}", axis, sign)


def _key_help(axes: Sequence[str]) -> str:
    """Return which keys do what."""
    pairs = [(axis, *(key.removeprefix("Key") for key in KEYS[axis])) for axis in axes if axis in KEYS]
    steer = ", ".join(f"**{more} {less}** {axis}" for axis, more, less in pairs)
    return f"{steer}; **shift** full; **space** go or pause, **.** step, **M** mark, **U** undo; or a gamepad"


def _index(names: tuple[str, ...], name: str) -> int:
    """Return the place of the last mark of a name."""
    return len(names) - 1 - names[::-1].index(name) if name in names else -1
