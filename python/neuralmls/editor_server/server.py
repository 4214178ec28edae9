"""A server for one browser on this machine: the built editor, one shape with its companions, and nothing else.

Every address that it answers is known before it starts, so that no request can name a file. Requests under another
name than this machine's own (DNS rebinding) and those that other pages make are refused.
"""

from __future__ import annotations

import errno
import json
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import urlsplit

from neuralmls.errors import ArgumentError, FileError

STATIC = Path(__file__).parent / "static"
ADDRESS = "127.0.0.1"
# The browser keeps unsaved work under the server's address and port, so that it should be the same each time.
USUAL_PORT = 8417

TYPES = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".wasm": "application/wasm",
}

# What the built editor may do, in a file of the build (editor/security.ts); and what only a header can say.
POLICY = "content-security-policy.txt"
NOT_IN_FRAMES = "frame-ancestors 'none'"

HEADERS = {
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-cache",
}


@dataclass(frozen=True)
class Session:
    """What is open when the editor starts."""

    shape: Path
    companions: dict[str, Path]
    """Files beside the shape, by the names that it gives them."""
    points: Path | None = None


class EditorServer(ThreadingHTTPServer):
    """Listens from its construction on; `serve_forever` answers."""

    daemon_threads = True

    def __init__(self, session: Session | None = None, *, port: int | None = None, static: Path = STATIC) -> None:
        """Listen on 127.0.0.1, at `port` or else at the usual port or, where that is taken, any.

        Raises
        ------
        FileError
            The editor has not been built into the folder `static`.
        ArgumentError
            The port is taken or not allowed.
        """
        if not all((static / name).is_file() for name in ("index.html", POLICY)):
            raise FileError("the editor has not been built here: run 'make editor', which needs Node.js 20 or later")
        policy = (static / POLICY).read_text(encoding="utf-8").strip()
        self.headers = {**HEADERS, "Content-Security-Policy": f"{policy}; {NOT_IN_FRAMES}"}
        self.contents: dict[str, Path | bytes] = {
            "/" + path.relative_to(static).as_posix(): path for path in static.rglob("*") if path.is_file()
        }
        self.contents["/"] = self.contents["/index.html"]
        if session is not None:
            self.contents |= _addresses(session)
        self.session = session
        try:
            super().__init__((ADDRESS, USUAL_PORT if port is None else port), _Handler)
        except OSError as error:
            if port is not None or error.errno != errno.EADDRINUSE:
                number = USUAL_PORT if port is None else port
                raise ArgumentError(f"port {number}: cannot listen there: {error.strerror or error}") from error
            super().__init__((ADDRESS, 0), _Handler)

    @property
    def url(self) -> str:
        """The page to open."""
        return f"http://{ADDRESS}:{self.server_port}/" + ("?session" if self.session else "")

    @property
    def hosts(self) -> set[str]:
        """The names by which a request may call this server."""
        return {f"{name}:{self.server_port}" for name in (ADDRESS, "localhost")}


def _addresses(session: Session) -> dict[str, Path | bytes]:
    """What the session adds, with a list of it that the editor reads first."""
    files = {session.shape.name: session.shape, **session.companions}
    contents: dict[str, Path | bytes] = {f"/session/{i}": path for i, path in enumerate(files.values())}
    listed = [{"name": name, "address": f"session/{i}"} for i, name in enumerate(files)]
    points = None
    if session.points is not None:
        contents["/session/points"] = session.points
        points = {"name": session.points.name, "address": "session/points"}
    described = {"shape": session.shape.name, "files": listed, "points": points}
    contents["/session.json"] = json.dumps(described).encode()
    return contents


class _Handler(BaseHTTPRequestHandler):
    server: EditorServer
    server_version = "neuralmls"
    sys_version = ""
    timeout = 60

    def do_GET(self) -> None:
        self._answer(with_body=True)

    def do_HEAD(self) -> None:
        self._answer(with_body=False)

    def _answer(self, *, with_body: bool) -> None:
        if refusal := self._refusal():
            self._send(403, refusal.encode(), "text/plain; charset=utf-8", with_body=with_body)
            return
        path = urlsplit(self.path).path
        content = self.server.contents.get(path)
        try:
            data = content.read_bytes() if isinstance(content, Path) else content
        except OSError:  # gone since
            data = None
        if data is None:
            self._send(404, b"there is nothing here", "text/plain; charset=utf-8", with_body=with_body)
            return
        name = "index.html" if path == "/" else path
        kind = "application/octet-stream" if path.startswith("/session/") else TYPES.get(Path(name).suffix.lower())
        self._send(200, data, kind or "application/octet-stream", with_body=with_body)

    def _refusal(self) -> str:
        """Why this request is refused; empty if it is not."""
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

    def _send(self, status: int, data: bytes, kind: str, *, with_body: bool) -> None:
        self.send_response(status)
        for name, value in self.server.headers.items():
            self.send_header(name, value)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        if with_body:
            self.wfile.write(data)

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing: the terminal shows the address."""
