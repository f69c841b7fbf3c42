# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Takes in what the script on the page sends: pressed keys, gamepads, and that it is still there."""

from __future__ import annotations

import itertools
import json
import threading
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import Server, ServerConnection, serve

from arcgym.teleop.player import Player
from arcgym.teleop.session import Session

COMMANDS = {"Space": "pause", "Period": "step", "KeyM": "mark", "KeyU": "undo"}
"""Keys that are pressed once, and what they do."""
LONGEST = 4096
"""Longest message [bytes]."""


class HandServer:
    """A web socket for the pages' scripts, one connection a tab, on loopback behind the gate."""

    def __init__(self, session: Session | Player, allowed: bool = True) -> None:
        """Listen at a free port.

        Args:
            session: What is steered, or just shown.
            allowed: Whether pages may steer, or just look.
        """
        self._session, self._allowed = session, allowed
        self._numbers = itertools.count()
        self.tabs = 0
        """Pages that are connected."""
        self.latency = float("nan")
        """Time from a page's message to its answer there, as measured by the page that sent last [s]."""
        self._server: Server = serve(self._serve, "127.0.0.1", 0, max_size=LONGEST, compression=None)
        self.port: int = self._server.socket.getsockname()[1]
        """Port."""
        threading.Thread(target=self._server.serve_forever, name="arcgym-hand", daemon=True).start()

    def close(self) -> None:
        """Stop listening."""
        self._server.shutdown()

    def _serve(self, connection: ServerConnection) -> None:
        source = f"tab {next(self._numbers)}"
        self.tabs += 1
        try:
            for message in connection:
                connection.send(json.dumps(self._answer(source, message)))
        except (ConnectionClosed, OSError):
            pass
        finally:
            self.tabs -= 1
            self._session.hand.drop(source)

    def _answer(self, source: str, message: str | bytes) -> dict[str, Any]:
        """Take a message in; what makes no sense is ignored."""
        hand, status = self._session.hand, self._session.status
        try:
            said = json.loads(message)
            keys = [str(key) for key in said.get("keys", ())]
            pad = said.get("pad") or {}
            hand.touch()
            if self._allowed:
                hand.command(source, hand.from_keys(keys) + hand.from_pad(pad), lasts=1.0)
                for key in said.get("pressed", ()):
                    self._do(COMMANDS.get(str(key)))
            if isinstance(said.get("latency"), (int, float)):
                self.latency = float(said["latency"])
            number = said.get("n")
        except (ValueError, TypeError, AttributeError):
            number = None
        return {"n": number, "state": status.state, "steps": status.steps, "axes": hand.axes}

    def _do(self, what: str | None) -> None:
        session: Any = self._session
        if what == "pause":
            session.pause(session.status.state in ("running", "waiting"))
        elif what == "step":
            session.single_step()
        elif what == "mark":
            session.mark()
        elif what == "undo":
            session.undo()
