# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The only door to a page: lets in who has the token, hands out the page, and passes the rest on to its servers."""

from __future__ import annotations

import asyncio
import contextlib
import hmac
import threading
from collections.abc import Mapping
from http import HTTPStatus
from http.cookies import SimpleCookie
from urllib.parse import parse_qs, urlsplit

LOOPBACK = ("127.0.0.1", "localhost", "::1")
"""Hosts that only this machine reaches."""
COOKIE = "arcgym_token"
"""Cookie that a browser with the token in its address is given."""
HEAD_LIMIT = 65536
"""Largest head of a request [bytes]."""
HEAD_TIME = 10.0
"""Longest time that a head may take [s]."""
NONSENSE = b"No request."
"""Answer to what is no HTTP request."""
NEEDED = b"This page needs the address that 'arcgym teleop' printed, with its token."
"""Answer to a request without token or cookie."""


class Gate:
    """Listens at one address. Backends listen on this machine's loopback alone.

    A browser shows its token once, in the address, and keeps it as a cookie that other sites cannot use. Web sockets
    of pages from elsewhere are refused, as are names of this machine that are not its own (without a token).
    """

    def __init__(
        self, host: str, port: int, token: str | None, pages: Mapping[str, tuple[str, bytes]], ports: Mapping[str, int]
    ) -> None:
        """Prepare; :meth:`start` listens.

        Args:
            host: Address to listen at.
            port: Port; 0 takes a free one.
            token: What a browser must know; None lets everybody in, for loopback alone.
            pages: Type and content of what is handed out here, by path.
            ports: Port of the backend, by path; that of ``*`` has all others.

        Raises:
            ValueError: If the host is not loopback and there is no token.
        """
        if token is None and host not in LOOPBACK:
            raise ValueError(f"A page at {host} needs a token.")
        self.host, self.port, self.token = host, port, token
        self._pages, self._ports = dict(pages), dict(ports)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="arcgym-gate", daemon=True)

    @property
    def url(self) -> str:
        """Address to open, with the token if there is one."""
        host = "localhost" if self.host in LOOPBACK else self.host
        return f"http://{host}:{self.port}/" + (f"?token={self.token}" if self.token else "")

    def start(self) -> None:
        """Listen.

        Raises:
            OSError: If the port is taken.
        """
        self._thread.start()
        starting = asyncio.start_server(self._serve, self.host, self.port, limit=HEAD_LIMIT)
        self._server = asyncio.run_coroutine_threadsafe(starting, self._loop).result()
        self.port = self._server.sockets[0].getsockname()[1]

    def close(self) -> None:
        """Stop listening."""
        asyncio.run_coroutine_threadsafe(self._end(), self._loop).result(timeout=5.0)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(timeout=5.0)

    async def _end(self) -> None:
        """Let go of everybody."""
        self._server.close()
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            head = await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), HEAD_TIME)
            await self._answer(head, reader, writer)
        except (TimeoutError, OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError):
            pass  # who asked is gone, or does not say what
        except ValueError:  # an address or a host that is none
            with contextlib.suppress(OSError):
                await _reply(writer, HTTPStatus.BAD_REQUEST, NONSENSE)
        finally:
            with contextlib.suppress(OSError):
                writer.close()

    async def _answer(self, head: bytes, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        lines = head.decode("latin-1").split("\r\n")
        parts = lines[0].split(" ")
        headers = {
            name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines[1:])
        }
        if len(parts) != 3:
            return await _reply(writer, HTTPStatus.BAD_REQUEST, NONSENSE)
        address = urlsplit(parts[1])
        if not self._is_own(headers):
            return await _reply(writer, HTTPStatus.FORBIDDEN, b"This page is not open to other sites.")
        shown = parse_qs(address.query).get("token", [""])[0]
        if self.token and self._is_token(shown) and "upgrade" not in headers:
            cookie = f"{COOKIE}={self.token}; HttpOnly; SameSite=Strict; Path=/"
            return await _reply(
                writer, HTTPStatus.SEE_OTHER, b"", {"Location": address.path or "/", "Set-Cookie": cookie}
            )
        if self.token and not self._is_token(_cookie(headers)):
            return await _reply(writer, HTTPStatus.FORBIDDEN, NEEDED)
        if address.path in self._pages and "upgrade" not in headers:
            kind, content = self._pages[address.path]
            return await _reply(writer, HTTPStatus.OK, content, {"Content-Type": kind, "Cache-Control": "no-store"})
        await self._pass_on(self._ports.get(address.path, self._ports["*"]), head, headers, reader, writer)

    def _is_own(self, headers: Mapping[str, str]) -> bool:
        """Whether a request was made to this host's name, and not by a page from elsewhere."""
        host = headers.get("host", "")
        if self.token is None and (urlsplit(f"//{host}").hostname or "") not in LOOPBACK:
            return False
        origin = headers.get("origin")
        return origin is None or urlsplit(origin).netloc == host

    def _is_token(self, text: str) -> bool:
        return self.token is not None and hmac.compare_digest(text.encode(), self.token.encode())

    async def _pass_on(
        self,
        port: int,
        head: bytes,
        headers: Mapping[str, str],
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
    ) -> None:
        """Copy bytes both ways. Requests that are no web sockets are the only ones of their connection."""
        if "upgrade" not in headers:
            kept = [line for line in head[:-4].split(b"\r\n") if not line.lower().startswith(b"connection:")]
            head = b"\r\n".join([*kept, b"Connection: close", b"", b""])
        back_reader, back_writer = await asyncio.open_connection("127.0.0.1", port)
        back_writer.write(head)
        ways = [
            asyncio.create_task(_copy(reader, back_writer)),
            asyncio.create_task(_copy(back_reader, writer)),
        ]
        await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
        for way in ways:
            way.cancel()
        back_writer.close()


async def _copy(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    with contextlib.suppress(OSError):
        while block := await reader.read(65536):
            writer.write(block)
            await writer.drain()


async def _reply(
    writer: asyncio.StreamWriter, status: HTTPStatus, content: bytes, headers: Mapping[str, str] | None = None
) -> None:
    fields = {"Content-Type": "text/plain", "Content-Length": str(len(content)), "Connection": "close"}
    fields |= dict(headers or {})
    head = f"HTTP/1.1 {status.value} {status.phrase}\r\n" + "".join(f"{k}: {v}\r\n" for k, v in fields.items())
    writer.write(head.encode("latin-1") + b"\r\n" + content)
    await writer.drain()


def _cookie(headers: Mapping[str, str]) -> str:
    cookies = SimpleCookie(headers.get("cookie", ""))
    return cookies[COOKIE].value if COOKIE in cookies else ""
