# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Who is let in, with a backend that says what it was asked."""

from __future__ import annotations

import http.client
import socket
import threading
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.sync.server import serve

from arcgym.teleop.gate import Gate


class Echo(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def do_GET(self) -> None:
        said = f"backend {self.path}".encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(said)))
        self.end_headers()
        self.wfile.write(said)

    def log_message(self, *_) -> None:
        """Say nothing."""


@pytest.fixture(scope="module")
def ports() -> Iterator[dict[str, int]]:
    plain = HTTPServer(("127.0.0.1", 0), Echo)
    sockets = serve(lambda ws: [ws.send(f"heard {text}") for text in ws], "127.0.0.1", 0)
    for server in (plain, sockets):
        threading.Thread(target=server.serve_forever, daemon=True).start()
    yield {"*": plain.server_port, "/hand": sockets.socket.getsockname()[1]}
    plain.shutdown()
    sockets.shutdown()


@pytest.fixture
def make_gate(ports) -> Iterator[Callable[..., Gate]]:
    made = []

    def make(token: str | None) -> Gate:
        gate = Gate("127.0.0.1", 0, token, {"/": ("text/html", b"the page")}, ports)
        gate.start()
        made.append(gate)
        return gate

    yield make
    for gate in made:
        gate.close()


def get(gate: Gate, path: str, **headers: str) -> tuple[int, bytes, dict[str, str]]:
    connection = http.client.HTTPConnection("127.0.0.1", gate.port, timeout=10)
    connection.request("GET", path, headers={"Host": f"localhost:{gate.port}", **headers})
    answer = connection.getresponse()
    return answer.status, answer.read(), dict(answer.getheaders())


def test_loopback_needs_no_token_but_the_right_name(make_gate) -> None:
    gate = make_gate(None)
    assert get(gate, "/")[:2] == (200, b"the page")
    assert get(gate, "/x?y=1")[:2] == (200, b"backend /x?y=1")
    assert get(gate, "/", Host="evil.example")[0] == 403
    assert get(gate, "/", Origin="http://evil.example")[0] == 403
    with connect(f"ws://localhost:{gate.port}/hand") as hand:
        hand.send("hello")
        assert hand.recv() == "heard hello"
    with pytest.raises(InvalidStatus):
        connect(f"ws://localhost:{gate.port}/hand", origin="http://evil.example")


def test_the_token_is_asked_for_everywhere(make_gate) -> None:
    gate = make_gate("s3cret")
    for path in ("/", "/x", "/?token=", "/?token=S3cret", "/x?token=s3cre"):
        status, said, headers = get(gate, path)
        assert status == 403 and b"token" in said and "Set-Cookie" not in headers
    assert get(gate, "/", Cookie="arcgym_token=other")[0] == 403
    with pytest.raises(InvalidStatus):
        connect(f"ws://localhost:{gate.port}/hand")
    status, _, headers = get(gate, "/?token=s3cret")
    assert (status, headers["Location"]) == (303, "/") and "SameSite=Strict" in headers["Set-Cookie"]
    cookie = headers["Set-Cookie"].partition(";")[0]
    assert get(gate, "/", Cookie=cookie)[:2] == (200, b"the page")
    with connect(f"ws://localhost:{gate.port}/hand", additional_headers={"Cookie": cookie}) as hand:
        hand.send("hello")
        assert hand.recv() == "heard hello"


def test_each_plain_request_has_a_connection_of_its_own(make_gate) -> None:
    assert get(make_gate(None), "/x")[2].get("Connection", "close") == "close"


def test_addresses_that_others_reach_need_a_token(ports) -> None:
    with pytest.raises(ValueError, match="A page at 0.0.0.0 needs a token"):
        Gate("0.0.0.0", 0, None, {}, ports)


@pytest.mark.parametrize("line", [b"GET //[ HTTP/1.1", b"GET / HTTP/1.1\r\nHost: [", b"GET /"])
def test_a_request_that_makes_no_sense_is_answered_and_let_go(make_gate, line: bytes) -> None:
    with socket.create_connection(("127.0.0.1", make_gate(None).port), timeout=5.0) as connection:
        connection.sendall(line + b"\r\n\r\n")
        said = connection.makefile("rb").read()
    assert said.startswith((b"HTTP/1.1 400", b"HTTP/1.1 403"))
