"""Answers one request: who may ask, what there is, and with which headers it goes out."""

from __future__ import annotations

import http.client
import os
import secrets
import shutil
from collections.abc import Collection, Mapping
from http.server import BaseHTTPRequestHandler
from io import BytesIO
from pathlib import PurePosixPath
from typing import BinaryIO, Protocol

from neuralmls.editor_server.connections import Connections
from neuralmls.editor_server.folder import File

TYPES = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
    ".wasm": "application/wasm",
}
UNKNOWN = "application/octet-stream"

HEADERS = {
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-cache",
}

# Browsers send about one KB.
LONGEST_HEAD = 16 * 1024


class Serving(Protocol):
    """What a handler asks of its server."""

    contents: Mapping[str, File | bytes]
    hosts: Collection[str]
    policy: str
    token: str
    connections: Connections

    @property
    def url(self) -> str:
        """The editor's address."""

    def redeem(self, ticket: str) -> bool:
        """Whether this is the address that the browser was started with, which holds once."""


class Handler(BaseHTTPRequestHandler):
    """One request, after which the connection is closed."""

    server: Serving  # type: ignore[assignment]
    server_version = "neuralmls"
    sys_version = ""
    timeout = 60

    def handle(self) -> None:
        self.rfile: BinaryIO = _Head(self.rfile)  # type: ignore[assignment]
        try:
            super().handle()
        except http.client.LineTooLong:  # the request line: what BaseHTTPRequestHandler knows of it is nothing yet
            self.requestline, self.request_version, self.command = "", self.protocol_version, ""
            self.send_error(414)

    def do_GET(self) -> None:
        self._answer(with_body=True)

    def do_HEAD(self) -> None:
        self._answer(with_body=False)

    def _answer(self, *, with_body: bool) -> None:
        if not self.path.startswith("/"):
            self._say(400, "expected an address that begins with /", with_body=with_body)
            return
        if refusal := self._refusal():
            self._say(403, refusal, with_body=with_body)
            return
        token, slash, name = self.path.partition("?")[0].removeprefix("/").partition("/")
        if with_body and not slash and self.server.redeem(token):
            self.send_response(303)
            self._end_headers({"Location": self.server.url, "Content-Length": "0"})
            return
        if not secrets.compare_digest(token.encode(), self.server.token.encode()):
            self._say(403, "open the address that neuralmls edit has printed", with_body=with_body)
            return
        self.server.connections.asked(self.connection)
        content = self.server.contents.get(slash + name)
        try:
            stream = content.open() if isinstance(content, File) else BytesIO(content) if content else None
        except OSError:  # gone since, or something else is in its place
            stream = None
        if stream is None:
            self._say(404, "there is nothing here", with_body=with_body)
            return
        kind = UNKNOWN if name.startswith("session/") else TYPES.get(PurePosixPath(name or "index.html").suffix.lower())
        with stream:
            self._send(200, stream, kind or UNKNOWN, with_body=with_body)

    def _refusal(self) -> str:
        """Why this request is refused, whatever it asks for; empty if it is not."""
        hosts = self.headers.get_all("Host", [])
        if len(hosts) != 1 or hosts[0].lower() not in self.server.hosts:
            return "this server answers under its own address only"
        origin = self.headers.get("Origin")
        if origin is not None and origin.lower() not in {f"http://{host}" for host in self.server.hosts}:
            return "this server answers its own pages only"
        # A link to the editor may come from anywhere; what a page of another origin embeds may not.
        foreign = self.headers.get("Sec-Fetch-Site", "none") not in {"none", "same-origin"}
        if foreign and self.headers.get("Sec-Fetch-Mode") != "navigate":
            return "this server answers its own pages only"
        return ""

    def _say(self, status: int, sentence: str, *, with_body: bool) -> None:
        self._send(status, BytesIO(sentence.encode()), TYPES[".txt"], with_body=with_body)

    def _send(self, status: int, stream: BinaryIO, kind: str, *, with_body: bool) -> None:
        size = stream.seek(0, os.SEEK_END)
        stream.seek(0)
        self.send_response(status)
        self._end_headers({"Content-Type": kind, "Content-Length": str(size)})
        if with_body:
            shutil.copyfileobj(stream, self.wfile, 1 << 18)

    def _end_headers(self, headers: dict[str, str]) -> None:
        for name, value in {**HEADERS, "Content-Security-Policy": self.server.policy, **headers}.items():
            self.send_header(name, value)
        self.end_headers()

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing: the terminal shows the address."""


class _Head:
    """What a client says, up to a length that no request of ours comes near."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._left = LONGEST_HEAD

    def readline(self, limit: int) -> bytes:
        line = self._stream.readline(min(limit, self._left + 1))
        self._left -= len(line)
        if self._left < 0:
            raise http.client.LineTooLong("request")
        return line

    def close(self) -> None:
        self._stream.close()
